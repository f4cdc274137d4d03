#include "dump/dump.h"
#include "tools/dump_support.h"

#include <Imath/ImathBox.h>
#include <Imath/ImathMatrix.h>
#include <OpenEXR/ImfBoxAttribute.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTimeCodeAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>

namespace gicodec::tools {
namespace {

const TextureDesc kDesc = probe_texture(Format::R16G16_SFLOAT, {2, 1, 2}, 6, 1, Tiling::atlas_xy_z);

/// A dump file with attributes that only OpenEXR's own classes have touched.
void write_with_attributes(const std::string& path) {
  const Extent size = image_extent(kDesc);
  Imf::Header header(static_cast<int>(size.width), static_cast<int>(size.height));
  header.insert("gicodec:grid", Imf::V3iAttribute({2, 1, 2}));
  header.insert("a:string", Imf::StringAttribute("two words\nand a line"));
  header.insert("a:empty", Imf::StringAttribute(""));
  header.insert("a:latin", Imf::StringAttribute("caf\xE9"));
  header.insert("a:prefix", Imf::StringAttribute("0x12, no number"));
  header.insert("a:int", Imf::IntAttribute(-2147483647));
  header.insert("a:float", Imf::FloatAttribute(0.1F));
  header.insert("a:denormal", Imf::FloatAttribute(std::numeric_limits<float>::denorm_min()));
  header.insert("a:nan", Imf::FloatAttribute(std::bit_cast<float>(0x7FC12345U)));
  header.insert("a:zero", Imf::FloatAttribute(-0.0F));
  header.insert("a:double", Imf::DoubleAttribute(1.0 / 3));
  header.insert("a:v2i", Imf::V2iAttribute({-1, 7}));
  header.insert("a:v3f", Imf::V3fAttribute({1.5F, -2, 1e30F}));
  header.insert("a:m44f", Imf::M44fAttribute(Imath::M44f(2.0F)));
  header.insert("a:box", Imf::Box2iAttribute({{1, 2}, {3, 4}}));
  header.insert("a:strings", Imf::StringVectorAttribute({"x", "", "yz"}));
  header.insert("a:time", Imf::TimeCodeAttribute(Imf::TimeCode(1, 2, 3, 4)));
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.channels().insert("G", Imf::Channel(Imf::HALF));
  std::vector<char> samples(std::size_t{size.width} * size.height * 2);
  Imf::FrameBuffer source;
  for (const char* name : {"R", "G"}) {
    source.insert(name, Imf::Slice(Imf::HALF, samples.data(), 2, std::size_t{size.width} * 2));
  }
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(source);
  file.writePixels(static_cast<int>(size.height));
}

TEST(Attributes, EveryTypeComesBackByteForByte) {
  const TemporaryDirectory directory;
  write_with_attributes(directory.path("in.exr"));
  const Dump dump = read_dump(directory.path("in.exr"));
  write_dump(directory.path("out.exr"), dump.info, dump.texels);
  EXPECT_EQ(file_bytes(directory.path("in.exr")), file_bytes(directory.path("out.exr")));
}

TEST(Attributes, TextIsReadable) {
  const TemporaryDirectory directory;
  write_with_attributes(directory.path("in.exr"));
  const Attributes attributes = read_dump_info(directory.path("in.exr")).attributes;
  const auto value = [&](const char* name) { return find_attribute(attributes, name)->value; };
  EXPECT_EQ(value("a:string"), "two words\nand a line");
  EXPECT_EQ(value("a:latin"), "0x636166e9");
  EXPECT_EQ(value("a:prefix"), "0x307831322c206e6f206e756d626572");
  EXPECT_EQ(value("a:int"), "-2147483647");
  EXPECT_EQ(value("a:float"), "0.1");
  EXPECT_EQ(value("a:v3f"), "1.5 -2 1e+30");
  EXPECT_EQ(value("a:nan"), "0x4523c17f");
  EXPECT_EQ(value("gicodec:grid"), "2 1 2");
}

TEST(Attributes, DamagedTextIsRefused) {
  Dump dump = random_dump(kDesc, 1);
  for (const Attribute& attribute :
       {Attribute{"a", "int", "12x"}, Attribute{"a", "int", ""}, Attribute{"a", "v3f", "1 2"},
        Attribute{"a", "double", "0x00"}, Attribute{"a", "m44f", "zz"},
        Attribute{"a", "nothing", "1"}, Attribute{"channels", "chlist", "0x00"},
        Attribute{"compression", "compression", "0x"}, Attribute{"", "int", "1"},
        Attribute{"dataWindow", "box2i", "0x00000000000000000000000000000000"},
        Attribute{"lineOrder", "int", "1"}, Attribute{"a", "stringvector", "0xffffff7f41"},
        Attribute{std::string(256, 'a'), "int", "1"},
        Attribute{std::string("a\0b", 3), "int", "1"}}) {
    Dump wrong = dump;
    set_attribute(wrong.info.attributes, attribute);
    EXPECT_THROW((void)to_exr({&wrong, 1}, "x.exr"), Error)
        << attribute.name << " " << attribute.type << " " << attribute.value;
  }
}

}  // namespace
}  // namespace gicodec::tools
