//! Texels on the CPU.

use bevy::{
    math::{IVec2, UVec2, ivec2},
    render::render_resource::TextureFormat,
};
use bytemuck::AnyBitPattern;
use half::f16;

/// The texels of one layer of one mip level, row by row from the top, without padding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextureData {
    /// Width and height in texels.
    pub size: UVec2,
    /// Format of the texture.
    pub format: TextureFormat,
    /// The texels, `size.x * size.y` times the bytes of one.
    pub bytes: Vec<u8>,
}

/// Texels by position; `(0, 0)` is the upper left.
///
/// # Panics
/// These methods panic, as indexing does, outside the texture and if the requested type is not as
/// large as a texel.
impl TextureData {
    /// A larger image with these texels at `origin`, as far as they lie in it; all others are
    /// `nothing`.
    pub fn placed(&self, origin: IVec2, size: UVec2, nothing: &[u8]) -> Self {
        let texel = self.bytes.len() / (self.size.x * self.size.y) as usize;
        let mut bytes = Vec::with_capacity((size.x * size.y) as usize * texel);
        for y in 0..size.y as i32 {
            for x in 0..size.x as i32 {
                let at = ivec2(x, y) - origin;
                if at.cmplt(IVec2::ZERO).any() || at.cmpge(self.size.as_ivec2()).any() {
                    bytes.extend(&nothing[..texel]);
                } else {
                    let start = (at.y as u32 * self.size.x + at.x as u32) as usize * texel;
                    bytes.extend(&self.bytes[start..start + texel]);
                }
            }
        }
        Self {
            size,
            format: self.format,
            bytes,
        }
    }

    /// The texel as any plain type of its size.
    pub fn texel<T: AnyBitPattern>(&self, x: u32, y: u32) -> T {
        assert!(
            x < self.size.x && y < self.size.y,
            "texel ({x}, {y}) is outside a texture of {}",
            self.size
        );
        let bytes = self.bytes.len() / (self.size.x * self.size.y) as usize;
        let start = (y * self.size.x + x) as usize * bytes;
        bytemuck::pod_read_unaligned(&self.bytes[start..start + bytes])
    }

    /// All texels row by row.
    pub fn texels<T: AnyBitPattern>(&self) -> impl Iterator<Item = T> {
        let UVec2 {
            x: width,
            y: height,
        } = self.size;
        (0..height).flat_map(move |y| (0..width).map(move |x| self.texel(x, y)))
    }

    /// A texel of `R32Float` or `Depth32Float`.
    pub fn f32(&self, x: u32, y: u32) -> f32 {
        self.texel(x, y)
    }

    /// A texel of `Rg32Float`.
    pub fn f32x2(&self, x: u32, y: u32) -> [f32; 2] {
        self.texel(x, y)
    }

    /// A texel of `Rgba32Float`.
    pub fn f32x4(&self, x: u32, y: u32) -> [f32; 4] {
        self.texel(x, y)
    }

    /// A texel of `R16Float`, widened.
    pub fn f16(&self, x: u32, y: u32) -> f32 {
        f16::from_bits(self.texel(x, y)).to_f32()
    }

    /// A texel of `Rg16Float`, widened.
    pub fn f16x2(&self, x: u32, y: u32) -> [f32; 2] {
        self.texel::<[u16; 2]>(x, y)
            .map(|bits| f16::from_bits(bits).to_f32())
    }

    /// A texel of `Rgba16Float`, widened.
    pub fn f16x4(&self, x: u32, y: u32) -> [f32; 4] {
        self.texel::<[u16; 4]>(x, y)
            .map(|bits| f16::from_bits(bits).to_f32())
    }

    /// A texel of `R32Uint`.
    pub fn u32(&self, x: u32, y: u32) -> u32 {
        self.texel(x, y)
    }

    /// A texel of `Rg32Uint`.
    pub fn u32x2(&self, x: u32, y: u32) -> [u32; 2] {
        self.texel(x, y)
    }

    /// A texel of `Rgba32Uint`.
    pub fn u32x4(&self, x: u32, y: u32) -> [u32; 4] {
        self.texel(x, y)
    }

    /// A texel of one of the `R8` formats, as stored.
    pub fn u8(&self, x: u32, y: u32) -> u8 {
        self.texel(x, y)
    }

    /// A texel of one of the `Rgba8` formats, as stored (sRGB is not decoded).
    pub fn u8x4(&self, x: u32, y: u32) -> [u8; 4] {
        self.texel(x, y)
    }
}
