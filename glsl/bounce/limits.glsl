// Height above the cluster's plane from which on things are in the map; in units of the distance that the maps end at.
const float LEAST_HEIGHT = 1e-5;
