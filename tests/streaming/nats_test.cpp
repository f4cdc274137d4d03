// Names of tracks on NATS, what servers answer, and flags.
#include "stream/nats_tracks.h"

#include "dump/error.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace gicodec::streaming {
namespace {

tools::NatsMessage answer(const std::string& text, const std::string& status = "") {
  tools::NatsMessage message;
  const auto bytes = std::as_bytes(std::span(text));
  message.data.assign(bytes.begin(), bytes.end());
  message.status = status;
  return message;
}

TEST(NatsSubjects, NamesAreOneTokenEach) {
  EXPECT_EQ(subject_token("world"), "world");
  EXPECT_EQ(subject_token("a.b *>\t"), "a%2Eb%20%2A%3E%09");
  EXPECT_EQ(subject_token("100%"), "100%25");
  EXPECT_EQ(subject_token("ü"), "%C3%BC");
  EXPECT_EQ(subject_token(""), "%");
  // Different names have different tokens.
  std::set<std::string> tokens;
  for (int c = 0; c < 256; ++c) tokens.insert(subject_token(std::string(1, static_cast<char>(c))));
  EXPECT_EQ(tokens.size(), 256U);
  for (const std::string& token : tokens)
    EXPECT_EQ(token.find_first_of(" .*>\t\r\n"), std::string::npos);
}

TEST(NatsSubjects, EachObjectHasItsOwn) {
  const TrackSubjects subjects("studio.a");
  const TrackName track{"the.world", "color", {3, 0, 12}};
  EXPECT_EQ(subjects.object(track, 0), "studio.a.the%2Eworld.color.3.0.12");
  EXPECT_EQ(subjects.object(track, 17), "studio.a.the%2Eworld.color.3.0.12.17");
  EXPECT_EQ(subjects.updates(track), "studio.a.the%2Eworld.color.3.0.12.*");
  EXPECT_EQ(subjects.list(), "studio.a.list");
  EXPECT_EQ(subjects.kept_stream(), "studio~a-last");
  EXPECT_EQ(subjects.update_stream(), "studio~a-updates");
  const auto kept = subjects.kept_subjects(), updates = subjects.update_subjects();
  for (const std::string& subject : updates)
    EXPECT_EQ(std::count(kept.begin(), kept.end(), subject), 0);
}

TEST(NatsSubjects, PrefixesMakeSubjects) {
  for (const char* prefix : {"", ".", "a..b", ".a", "a.", "a b", "a*", ">", "a\n", "ü"})
    EXPECT_THROW(TrackSubjects{prefix}, tools::Error) << prefix;
  EXPECT_THROW(TrackSubjects{std::string(100, 'a')}, tools::Error);
  EXPECT_NO_THROW(TrackSubjects{"light-2.studio_b"});
}

TEST(NatsUrls, AreOfNats) {
  EXPECT_EQ(nats_urls("nats://a:1,tls://b", "--nats"),
            (std::vector<std::string>{"nats://a:1", "tls://b"}));
  for (const char* urls : {"", "a:1", "http://a", "nats://", "nats://a,", "nats://a,b:1"})
    EXPECT_THROW((void)nats_urls(urls, "--nats"), tools::Error) << urls;
  try {
    (void)nats_urls("nats://user:secret@a", "--nats");
    ADD_FAILURE() << "a password in a URL is refused";
  } catch (const tools::Error& error) {
    EXPECT_EQ(std::string(error.what()).find("secret"), std::string::npos) << error.what();
  }
}

TEST(NatsAnswers, AreReadOrRefused) {
  const StreamAnswer stored = stream_answer(answer(R"({"stream":"s","seq":7})"));
  EXPECT_EQ(stored.error, 0);
  EXPECT_EQ(stored.stream, "s");
  EXPECT_EQ(stored.sequence, 7U);
  EXPECT_EQ(
      stream_answer(answer(R"({"error":{"code":400,"err_code":10059,"description":"d"}})")).error,
      kErrorNoStream);
  EXPECT_NE(stream_answer(answer("", "503")).error, 0);
  for (const char* text :
       {"", "{", "[]", "null", R"({"error":{}})", R"({"error":{"err_code":"x"}})"})
    EXPECT_NE(stream_answer(answer(text)).error, 0) << text;
  // Of types that nobody expects.
  EXPECT_EQ(stream_answer(answer(R"({"error":[1],"stream":3,"seq":"x"})")).sequence, 0U);
}

}  // namespace
}  // namespace gicodec::streaming
