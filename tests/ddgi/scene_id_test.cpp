// Whether two ends mean the same scene, and what is said if not.
#include "ddgi/scene_id.h"
#include "ddgi/scenes.h"

#include <gtest/gtest.h>

#include <map>
#include <string_view>

namespace gicodec::ddgi {
namespace {

TEST(SceneId, ChangesWithTheTrianglesAndNothingElse) {
  Scene scene = *make_scene("tomb");
  const SceneId id = scene_id("tomb", scene);
  EXPECT_EQ(scene_id("tomb", *make_scene("tomb")), id);
  EXPECT_NE(scene_id("tomb", *make_scene("villa")).geometry, id.geometry);
  scene.lights.clear();
  EXPECT_EQ(scene_id("other", scene).geometry, id.geometry);

  Scene moved = scene, bent = scene, dynamic = scene;
  moved.objects.front().transform.t.x += 1;
  bent.meshes[bent.objects.front().meshes.front()].positions.front().y += 0.5F;
  dynamic.objects.front().dynamic = !dynamic.objects.front().dynamic;
  for (const Scene& other : {moved, bent, dynamic}) {
    EXPECT_NE(scene_id("tomb", other).geometry, id.geometry);
  }
}

// Whatever the compiler and its options: ends that do not agree in the hash cannot talk.
TEST(SceneId, BuiltInScenesAreTheSameFromEachCompiler) {
  const std::map<std::string_view, std::uint64_t> golden{
      {"tomb", 0x3096adac2890affc}, {"villa", 0x30a3c937b278c1ce}, {"street", 0x8229f5c8d85073eb}};
  EXPECT_EQ(built_in_scenes().size(), golden.size());
  for (const SceneInfo& info : built_in_scenes())
    EXPECT_EQ(scene_id("", info.make()).geometry, golden.at(info.name)) << info.name;
}

TEST(SceneId, NamesAreTextThatAWelcomeTakes) {
  EXPECT_EQ(scene_name("Küche"), "Küche");
  for (const std::string& label :
       {std::string("\xff\xfe.glb"), std::string("\x1b[2J"), std::string(300, 'x'),
        std::string(254, 'x') + "\u20AC", std::string(255, '\xff'), std::string()}) {
    const Welcome welcome{.ticket = {std::byte{1}}, .scene = {scene_name(label), 1}};
    Message message;
    EXPECT_EQ(write_message(welcome, message), Status::ok) << label;
  }
}

TEST(SceneId, SaysBothNamesAndWhatToDo) {
  const SceneId own{"tomb", 1};
  EXPECT_FALSE(refusal(own, {"tomb", 1}));
  EXPECT_FALSE(refusal(own, {"renamed.glb", 1}));
  EXPECT_FALSE(refusal(own, {"tomb", 0}));  // A recording of which only the name is known.
  EXPECT_FALSE(refusal(own, {"", 0}));      // Nothing is.
  EXPECT_EQ(refusal(own, {"villa", 2}),
            "the server streams villa, and the scene here is tomb: use --scene villa");
  EXPECT_EQ(refusal(own, {"room.glb", 0}),
            "the server streams room.glb, and the scene here is tomb: use --gltf room.glb");
  EXPECT_EQ(refusal(own, {"a\033[2Jb", 2}),
            "the server streams a\\x1b[2Jb, and the scene here is tomb: use --gltf a\\x1b[2Jb");
  EXPECT_TRUE(refusal(own, {"tomb", 2})->find("other triangles") != std::string::npos);
  EXPECT_TRUE(refusal(own, {"", 2})->find("another scene than tomb") != std::string::npos);
}

}  // namespace
}  // namespace gicodec::ddgi
