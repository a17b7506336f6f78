//! Pictures in memory: read back from the device, written as PNG.

use std::io::Write;

use crate::gpu::{Gpu, read_mapped};

use super::error::RenderError;
use super::targets::check_size;

/// A picture of 8-bit sRGB texels, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    /// Red, green, blue, opacity.
    pub rgba8: Vec<u8>,
}

/// A texture to draw a picture into when there is no window.
#[derive(Debug)]
pub struct PictureTarget {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    size: [u32; 2],
}

impl PictureTarget {
    /// Format to give to [`Renderer::new`](super::Renderer::new).
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// A target of this size in pixels.
    ///
    /// # Errors
    /// `PictureSize` or `PictureBytes` for what the device cannot hold.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, RenderError> {
        check_size(gpu, size, 1)?;
        let texture = gpu.guarded("the picture", || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: Self::FORMAT,
                // Bound as a texture where it is one step on the way to a window.
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        })?;
        Ok(Self {
            view: texture.create_view(&Default::default()),
            texture,
            size,
        })
    }

    /// Waits for the device and reads the picture back.
    ///
    /// # Errors
    /// The device's own.
    pub fn read(&self, gpu: &Gpu) -> Result<Picture, RenderError> {
        let [width, height] = self.size;
        // Rows of a copy start at multiples of 256 bytes.
        let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = gpu.guarded("the picture's copy", || {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("picture, read back"),
                size: u64::from(stride) * u64::from(height),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        })?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(stride),
                    rows_per_image: None,
                },
            },
            self.texture.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        let bytes = read_mapped(gpu, "the picture", &copy)?;
        let rgba8 = bytes
            .chunks_exact(stride as usize)
            .flat_map(|row| &row[..width as usize * 4])
            .copied()
            .collect();
        Ok(Picture {
            width,
            height,
            rgba8,
        })
    }
}

impl Picture {
    /// The picture as a PNG file's bytes, with texts such as scene, tick, seed and version.
    ///
    /// # Errors
    /// `Png`, for a keyword PNG does not allow (1 to 79 Latin-1 characters).
    pub fn to_png(&self, texts: &[(&str, &str)]) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        let mut writer = encoder(&mut bytes, [self.width, self.height], texts)?.write_header()?;
        writer.write_image_data(&self.rgba8)?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// A PNG file of several pictures, shown one after the other without end (APNG).
pub struct Animation<W: Write> {
    writer: png::Writer<W>,
}

impl<W: Write> Animation<W> {
    /// Starts an animation of `frames` pictures of one size, at least one, `hz` of them a second.
    ///
    /// # Errors
    /// `Png`, as for [`Picture::to_png`], and what `out` reports.
    pub fn new(
        out: W,
        size: [u32; 2],
        frames: u32,
        hz: u16,
        texts: &[(&str, &str)],
    ) -> Result<Self, RenderError> {
        let mut encoder = encoder(out, size, texts)?;
        encoder.set_animated(frames, 0)?;
        encoder.set_frame_delay(1, hz)?;
        Ok(Self {
            writer: encoder.write_header()?,
        })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// `Png`, for a picture of another size or one too many, and what the output reports.
    pub fn add(&mut self, picture: &Picture) -> Result<(), RenderError> {
        Ok(self.writer.write_image_data(&picture.rgba8)?)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// `Png`, if pictures are missing, and what the output reports.
    pub fn finish(self) -> Result<(), RenderError> {
        Ok(self.writer.finish()?)
    }
}

fn encoder<'a, W: Write>(
    out: W,
    [width, height]: [u32; 2],
    texts: &[(&str, &str)],
) -> Result<png::Encoder<'a, W>, RenderError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (keyword, text) in texts {
        encoder.add_itxt_chunk((*keyword).to_owned(), (*text).to_owned())?;
    }
    Ok(encoder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_holds_the_pixels_and_the_texts() {
        let picture = Picture {
            width: 3,
            height: 2,
            rgba8: (0..24).collect(),
        };
        let bytes = picture
            .to_png(&[("Scene", "wiese äöü"), ("Tick", "7")])
            .expect("a PNG");
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().expect("a header");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut pixels).expect("pixels");
        assert_eq!(pixels, picture.rgba8);
        let texts = &reader.info().utf8_text;
        assert_eq!(texts.len(), 2);
        assert_eq!(texts[0].get_text().expect("text"), "wiese äöü");
    }

    #[test]
    fn an_animation_holds_every_picture() {
        let pictures = [0, 100].map(|first| Picture {
            width: 2,
            height: 1,
            rgba8: (first..first + 8).collect(),
        });
        let mut bytes = Vec::new();
        let mut animation = Animation::new(&mut bytes, [2, 1], 2, 30, &[]).expect("a start");
        for picture in &pictures {
            animation.add(picture).expect("a frame");
        }
        animation.finish().expect("an end");
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().expect("a header");
        assert_eq!(
            reader.info().animation_control.map(|c| c.num_frames),
            Some(2)
        );
        for picture in &pictures {
            let mut pixels = vec![0; 8];
            reader.next_frame(&mut pixels).expect("pixels");
            assert_eq!(pixels, picture.rgba8);
        }
    }
}
