//! Alpha masks of the passes that make points.

/// Binds what `glsl/visibility/masks.glsl` reads, if the scene has masked materials. Points in holes are counted in `$holes`, if that
/// is a counter.
macro_rules! masked {
    ($pass:expr, $around:expr, $holes:expr) => {
        match ($around.scene.masks, $holes) {
            (None, _) => $pass,
            (Some(masks), holes) => {
                let part = if holes.is_some() { "visibility/mask-counted" } else { "visibility/mask-texels" };
                let pass = $pass
                    .part("mask", part)
                    .reads("masks", masks.materials)
                    .reads("mask_corners", masks.corners)
                    .reads("mask_texels", masks.texels);
                match holes {
                    Some(holes) => pass.updates("holes", holes),
                    None => pass,
                }
            }
        }
    };
}

pub(super) use masked;
