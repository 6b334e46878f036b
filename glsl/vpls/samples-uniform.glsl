// View samples in uniform blocks, which all lanes read at the same place: up to 512, the 16 KiB that every device has for a block. Each part for
// "samples" defines
//     ViewSample sample_at(uint i);
//     ViewSampleLobe lobe_at(uint i);
layout(scalar) uniform ViewSamples { ViewSample at[512]; } view_samples;
layout(scalar) uniform ViewSampleLobes { ViewSampleLobe at[512]; } view_lobes;

ViewSample sample_at(uint i) { return view_samples.at[i]; }

ViewSampleLobe lobe_at(uint i) { return view_lobes.at[i]; }
