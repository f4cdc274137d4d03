// The C interface from Rust, by extern "C": a texture to packets and back.
//   rustc round_trip.rs -L FOLDER -l gicodec && ./round_trip
use std::ffi::{CStr, CString};
use std::os::raw::{c_char, c_int, c_void};
use std::ptr;

const COMPONENTS: usize = 16;

#[repr(C)]
#[derive(Clone, Copy)]
struct Component {
    name: [u8; 8],
    offset: u16,
    bits: u8,
    kind: u8,
}

// Structs begin with their size, and have the fields of the C header in its order.
#[repr(C)]
struct TextureDesc {
    struct_size: u32,
    format: u32,
    grid: [u32; 3],
    block: [u32; 3],
    guard_band: u32,
    space: u32,
    presence: u32,
    model: u32,
    records: [u32; 3],
    tiling: u32,
    pad_before: u32,
    pad_after: u32,
    slots: [u32; 3],
    record_bytes: u32,
    component_count: u32,
    components: [Component; COMPONENTS],
}

#[repr(C)]
struct TextureInfo {
    struct_size: u32,
    blocks: u32,
    texture_bytes: u64,
    width: u64,
    height: u64,
    slices: u64,
    block_bytes: u32,
    presence_bytes: u32,
}

#[repr(C)]
struct View {
    struct_size: u32,
    bytes: *mut c_void,
    size: usize,
    row_pitch: usize,
    slice_pitch: usize,
    block_pitch: usize,
}

extern "C" {
    fn gicodec_status_text(status: c_int) -> *const c_char;
    fn gicodec_format_from_name(name: *const c_char) -> u32;
    fn gicodec_ddgi_irradiance(nx: u32, ny: u32, nz: u32, format: u32, out: *mut TextureDesc) -> c_int;
    fn gicodec_texture_desc_info(desc: *const TextureDesc, out: *mut TextureInfo) -> c_int;
    fn gicodec_encoder_create(
        desc: *const TextureDesc, options: *const c_void, out: *mut *mut c_void) -> c_int;
    fn gicodec_encoder_destroy(encoder: *mut c_void);
    fn gicodec_encoder_bound(encoder: *const c_void, blocks: usize) -> usize;
    fn gicodec_encoder_encode(
        encoder: *mut c_void, view: *const View, selection: u32, blocks: *const u32, count: usize,
        out: *mut u8, capacity: usize, size: *mut usize) -> c_int;
    fn gicodec_decoder_create(
        desc: *const TextureDesc, options: *const c_void, out: *mut *mut c_void) -> c_int;
    fn gicodec_decoder_destroy(decoder: *mut c_void);
    fn gicodec_decoder_decode(
        decoder: *mut c_void, packet: *const u8, size: usize, view: *const View) -> c_int;
}

/// A status as a Result, with the library's words.
fn check(status: c_int) -> Result<(), String> {
    if status == 0 {
        return Ok(());
    }
    let text = unsafe { CStr::from_ptr(gicodec_status_text(status)) };
    Err(text.to_string_lossy().into_owned())
}

fn sized<T>() -> T {
    // All zeros are the defaults of every struct.
    let mut value: T = unsafe { std::mem::zeroed() };
    unsafe { *(&mut value as *mut T as *mut u32) = std::mem::size_of::<T>() as u32 };
    value
}

fn view_of(texels: &mut [u8]) -> View {
    let mut view: View = sized();
    view.bytes = texels.as_mut_ptr() as *mut c_void;
    view.size = texels.len();
    view
}

struct Encoder(*mut c_void);
impl Drop for Encoder {
    fn drop(&mut self) {
        unsafe { gicodec_encoder_destroy(self.0) }
    }
}

struct Decoder(*mut c_void);
impl Drop for Decoder {
    fn drop(&mut self) {
        unsafe { gicodec_decoder_destroy(self.0) }
    }
}

fn main() -> Result<(), String> {
    let name = CString::new("A2B10G10R10_UNORM_PACK32").unwrap();
    let (mut desc, mut info): (TextureDesc, TextureInfo) = (sized(), sized());
    let (mut encoder, mut decoder) = (Encoder(ptr::null_mut()), Decoder(ptr::null_mut()));
    unsafe {
        check(gicodec_ddgi_irradiance(16, 8, 16, gicodec_format_from_name(name.as_ptr()), &mut desc))?;
        check(gicodec_texture_desc_info(&desc, &mut info))?;
        check(gicodec_encoder_create(&desc, ptr::null(), &mut encoder.0))?;
        check(gicodec_decoder_create(&desc, ptr::null(), &mut decoder.0))?;
    }
    let mut ours = vec![0u8; info.texture_bytes as usize];
    let mut theirs = ours.clone();
    let mut packet = vec![0u8; unsafe { gicodec_encoder_bound(encoder.0, info.blocks as usize) }];
    for frame in 0..3usize {
        for i in (frame..ours.len()).step_by(4001) {
            ours[i] = (i + frame) as u8;
        }
        let (from, to, mut size) = (view_of(&mut ours), view_of(&mut theirs), 0usize);
        unsafe {
            check(gicodec_encoder_encode(
                encoder.0, &from, 0, ptr::null(), 0, packet.as_mut_ptr(), packet.len(), &mut size))?;
            check(gicodec_decoder_decode(decoder.0, packet.as_ptr(), size, &to))?;
        }
        println!("frame {frame}: {size} bytes, texels {}", if ours == theirs { "equal" } else { "DIFFER" });
        if ours != theirs {
            return Err("the texels differ".into());
        }
    }
    Ok(())
}
