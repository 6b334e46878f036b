// View samples in storage buffers: any number.
layout(scalar) readonly buffer ViewSamples { ViewSample at[]; } view_samples;
layout(scalar) readonly buffer ViewSampleLobes { ViewSampleLobe at[]; } view_lobes;

ViewSample sample_at(uint i) { return view_samples.at[i]; }

ViewSampleLobe lobe_at(uint i) { return view_lobes.at[i]; }
