// The C interface from C#, by P/Invoke: a texture to packets and back. Engines that run C# put the same
// declarations into their own class.
//   mcs -unsafe RoundTrip.cs && mono RoundTrip.exe          # with libgicodec.so where the loader looks
using System;
using System.Runtime.InteropServices;

static unsafe class Gicodec
{
    const string Library = "gicodec";

    // Structs begin with their size, and have the fields of the C header in its order.
    [StructLayout(LayoutKind.Sequential)]
    public struct Component
    {
        public fixed byte name[8];
        public ushort offset;
        public byte bits, type;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct TextureDesc
    {
        public uint structSize, format;
        public fixed uint grid[3];
        public fixed uint block[3];
        public uint guardBand, space, presence, model;
        public fixed uint records[3];
        public uint tiling, padBefore, padAfter;
        public fixed uint slots[3];
        public uint recordBytes, componentCount;
        public fixed byte components[16 * 12];
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct TextureInfo
    {
        public uint structSize, blocks;
        public ulong textureBytes, width, height, slices;
        public uint blockBytes, presenceBytes;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct View
    {
        public uint structSize;
        public void* bytes;
        public UIntPtr size, rowPitch, slicePitch, blockPitch;
    }

    [DllImport(Library)] static extern IntPtr gicodec_status_text(int status);
    [DllImport(Library)] static extern uint gicodec_format_from_name(string name);
    [DllImport(Library)]
    static extern int gicodec_ddgi_irradiance(uint nx, uint ny, uint nz, uint format, ref TextureDesc desc);
    [DllImport(Library)]
    static extern int gicodec_texture_desc_info(ref TextureDesc desc, ref TextureInfo info);
    [DllImport(Library)]
    static extern int gicodec_encoder_create(ref TextureDesc desc, IntPtr options, out IntPtr encoder);
    [DllImport(Library)] static extern void gicodec_encoder_destroy(IntPtr encoder);
    [DllImport(Library)] static extern UIntPtr gicodec_encoder_bound(IntPtr encoder, UIntPtr blocks);
    [DllImport(Library)]
    static extern int gicodec_encoder_encode(IntPtr encoder, ref View view, uint selection, uint* blocks,
        UIntPtr count, byte[] packet, UIntPtr capacity, out UIntPtr size);
    [DllImport(Library)]
    static extern int gicodec_decoder_create(ref TextureDesc desc, IntPtr options, out IntPtr decoder);
    [DllImport(Library)] static extern void gicodec_decoder_destroy(IntPtr decoder);
    [DllImport(Library)]
    static extern int gicodec_decoder_decode(IntPtr decoder, byte[] packet, UIntPtr size, ref View view);

    static void Check(int status)
    {
        if (status != 0)
            throw new InvalidOperationException(Marshal.PtrToStringAnsi(gicodec_status_text(status)));
    }

    static View ViewOf(byte* bytes, int size)
    {
        return new View { structSize = (uint)sizeof(View), bytes = bytes, size = (UIntPtr)size };
    }

    static int Main()
    {
        var desc = new TextureDesc { structSize = (uint)sizeof(TextureDesc) };
        var info = new TextureInfo { structSize = (uint)sizeof(TextureInfo) };
        Check(gicodec_ddgi_irradiance(16, 8, 16, gicodec_format_from_name("A2B10G10R10_UNORM_PACK32"), ref desc));
        Check(gicodec_texture_desc_info(ref desc, ref info));
        var ours = new byte[info.textureBytes];
        var theirs = new byte[info.textureBytes];
        IntPtr encoder, decoder;
        Check(gicodec_encoder_create(ref desc, IntPtr.Zero, out encoder));
        Check(gicodec_decoder_create(ref desc, IntPtr.Zero, out decoder));
        var packet = new byte[(int)gicodec_encoder_bound(encoder, (UIntPtr)info.blocks)];
        bool good = true;
        for (int frame = 0; frame < 3; ++frame)
        {
            for (int i = frame; i < ours.Length; i += 4001) ours[i] = (byte)(i + frame);
            UIntPtr size;
            fixed (byte* from = ours, to = theirs)
            {
                View view = ViewOf(from, ours.Length), target = ViewOf(to, theirs.Length);
                Check(gicodec_encoder_encode(encoder, ref view, 0, null, UIntPtr.Zero, packet,
                    (UIntPtr)packet.Length, out size));
                Check(gicodec_decoder_decode(decoder, packet, size, ref target));
            }
            bool same = Convert.ToBase64String(ours) == Convert.ToBase64String(theirs);
            good = good && same;
            Console.WriteLine("frame {0}: {1} bytes, texels {2}", frame, size, same ? "equal" : "DIFFER");
        }
        gicodec_decoder_destroy(decoder);
        gicodec_encoder_destroy(encoder);
        return good ? 0 : 1;
    }
}
