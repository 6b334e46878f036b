// Least height of geometry in the map above the cluster's plane, in units of the maps' far distance.
const float LEAST_HEIGHT = 1e-5;
