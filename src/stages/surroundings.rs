//! The part of a frame that visibility, gather and direct light work in.

use super::gbuffer::GBuffer;
use super::residents::FrameResidents;
use super::rsm::Rsm;
use super::wants::Wants;
use crate::world::device::FrameScene;
use crate::world::projection::View;
use crate::world::traced::TracedHandles;

/// Inputs that methods of these slots share.
#[derive(Clone, Copy)]
pub struct Surroundings<'f> {
    pub scene: FrameScene<'f>,
    pub residents: FrameResidents<'f>,
    /// Acceleration structure for rays; `None` if no method traces rays.
    pub traced: Option<&'f TracedHandles>,
    pub view: &'f View,
    pub gbuffer: &'f GBuffer,
    pub rsm: &'f Rsm,
    pub wants: &'f Wants,
    /// The pixel that is asked why it is lit; rays are brought then.
    pub asked: Option<[u32; 2]>,
}
