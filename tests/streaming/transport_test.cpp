// Addresses as flags name them, and the limits of connections that are not web.cpp's alone.
#include "stream/transport.h"
#include "dump/error.h"
#include "stream/enet.h"
#include "stream/tcp.h"
#include "stream/tls.h"
#include "stream/web_link.h"
#include "stream/web_page.h"

#include <enet/enet.h>
#include <gtest/gtest.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <random>
#include <string_view>
#include <vector>

namespace gicodec::streaming {
namespace {

TEST(Transport, ReadsAddressesAndWritesThemAgain) {
  for (const char* text :
       {"127.0.0.1:4600", "[::1]:8443", "wss://example.org:443", "wss://[2001:db8::1]:8443",
        "ws://127.0.0.1:80", "ws://[::1]:80", "ws://localhost:80"}) {
    EXPECT_EQ(to_string(parse_server(text, "--connect")), text);
  }
  EXPECT_EQ(to_string(parse_server("wss://example.org:443/", "--connect")),
            "wss://example.org:443");
  for (const char* text : {"", ":1", "host", "host:", "host:x", "host:70000", "::1:80", "[]:80",
                           "[host]:80", "wss://", "wss://host", "http://host:80",
                           "ws://example.org:80", "ws://127.example.org:80", "ws://0.0.0.0:80"}) {
    EXPECT_THROW(static_cast<void>(parse_server(text, "--connect")), tools::Error) << text;
  }
}

TEST(Tcp, WhoIsOnThisMachine) {
  EXPECT_FALSE(peer_is_here(-1));
  for (const auto& [text, here] : {std::pair("127.0.0.1", true),
                                   {"127.9.9.9", true},
                                   {"::1", true},
                                   {"::ffff:127.0.0.1", true},
                                   {"192.0.2.1", false},
                                   {"2001:db8::1", false},
                                   {"::ffff:192.0.2.1", false}}) {
    addrinfo wanted{};
    wanted.ai_flags = AI_NUMERICHOST;
    wanted.ai_socktype = SOCK_DGRAM;  // which connects without a packet
    addrinfo* to = nullptr;
    ASSERT_EQ(getaddrinfo(text, "9", &wanted, &to), 0) << text;
    const int descriptor = socket(to->ai_family, SOCK_DGRAM, 0);
    // Of a machine without networks others cannot be reached.
    const bool reached = connect(descriptor, to->ai_addr, to->ai_addrlen) == 0;
    EXPECT_EQ(peer_is_here(descriptor), reached && here) << text;
    close(descriptor);
    freeaddrinfo(to);
  }
}

TEST(Transport, ReadsPins) {
  const std::string digits(64, 'a');
  EXPECT_EQ(parse_pin("sha256:" + digits), std::string(32, '\xaa'));
  std::string colons = "sha256:AA";
  for (int i = 1; i < 32; ++i) colons += ":AA";
  EXPECT_EQ(parse_pin(colons), std::string(32, '\xaa'));
  for (const std::string& wrong : {digits, "sha1:" + digits, "sha256:" + digits.substr(1),
                                   "sha256:" + digits + "a", "sha256:g" + digits.substr(1)}) {
    EXPECT_THROW(static_cast<void>(parse_pin(wrong)), tools::Error) << wrong;
  }
}

TEST(EnetLinks, WindowsStayAsAskedForWhoeverComesAndGoes) {
  using Clock = std::chrono::steady_clock;
  NetOptions options;
  options.links = 4;
  options.window = 3 << 20;
  Enet server({"127.0.0.1", 0}, options);
  Enet client(options), other(options);
  NetEvent event;
  Enet::Link seen = nullptr;
  const auto serve = [&](std::chrono::milliseconds time) {
    for (const auto end = Clock::now() + time; Clock::now() < end;) {
      if (server.next(event, 1) && event.type == NetEvent::Type::opened && seen == nullptr) {
        seen = event.link.enet;
      }
      while (client.next(event, 0) || other.next(event, 0)) {
      }
    }
  };
  const Enet::Link link = client.connect({"127.0.0.1", server.port()});
  serve(std::chrono::milliseconds(200));
  const Enet::Link second = other.connect({"127.0.0.1", server.port()});
  // ENet tells the other side of its bandwidth once a second, after somebody came or went.
  serve(std::chrono::milliseconds(2500));
  other.abandon(second);
  serve(std::chrono::milliseconds(1500));
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(link->windowSize, options.window);
  EXPECT_EQ(seen->windowSize, options.window);
}

TEST(HalfOpen, TheOldestOfWhoeverHasMostMakesRoom) {
  HalfOpen half_open;
  std::vector<std::unique_ptr<WebLink>> links;
  const auto add = [&](const char* host) {
    links.push_back(std::make_unique<WebLink>());
    links.back()->peer.host = host;
    return half_open.add(links.back().get());
  };
  EXPECT_EQ(add("honest"), nullptr);
  for (std::size_t i = 1; i < HalfOpen::kMax; ++i) EXPECT_EQ(add(i % 3 == 0 ? "a" : "b"), nullptr);
  for (int i = 0; i < 1000; ++i) {
    const WebLink* const out = add(i % 2 == 0 ? "a" : "b");
    ASSERT_NE(out, nullptr);
    EXPECT_NE(out->peer.host, "honest");
    EXPECT_LE(half_open.all().size(), HalfOpen::kMax);
  }
  EXPECT_EQ(half_open.all().front()->peer.host, "honest");
  EXPECT_EQ(half_open.take("nobody"), nullptr);
  EXPECT_EQ(half_open.take("honest"), links.front().get());
}

TEST(HalfOpen, OfAddressesWithOneEachTheOldestMakesRoomWhateverTheirNames) {
  constexpr std::size_t kAddresses = 200;
  std::vector<std::size_t> order(kAddresses);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::ranges::shuffle(order, std::mt19937(seed));
    HalfOpen half_open;
    std::vector<std::unique_ptr<WebLink>> links;
    for (std::size_t i = 0; i < kAddresses; ++i) {
      links.push_back(std::make_unique<WebLink>());
      links.back()->peer.host = "127.0.0." + std::to_string(order[i]);
      const WebLink* const out = half_open.add(links.back().get());
      EXPECT_EQ(out, i < HalfOpen::kMax ? nullptr : links[i - HalfOpen::kMax].get());
      EXPECT_EQ(half_open.all().back(), links.back().get());
    }
  }
}

TEST(WebLink, WhatIsNoMessageFloodsInTheEnd) {
  WebLink link;
  link.tcp.read = 60 << 10;
  EXPECT_FALSE(floods(link, 0));
  link.tcp.read = 70 << 10;
  EXPECT_TRUE(floods(link, 0));
  EXPECT_FALSE(floods(link, 1));
  // Messages as clients send them, 200 a second with what is around each.
  link.messages = 200;
  link.payload = link.messages * 12;
  link.tcp.read = link.payload + link.messages * 60;
  EXPECT_FALSE(floods(link, 1));
  // The same bytes as crumbs of one.
  link.messages = 1;
  link.payload = 1 << 20;
  link.tcp.read = link.payload * 7;
  EXPECT_TRUE(floods(link, 10));
}

TEST(WebPage, TellsNobodyWhatIsNotForThem) {
  const Shown shown{"gicodec_clients 1\n", 100};
  const auto status = [&](const WebRequest& request, const std::string& token, double now = 101) {
    return web_answer(request, shown, token, now).head.substr(9, 3);
  };
  EXPECT_EQ(status({true, "/health", "", false}, ""), "200");
  EXPECT_EQ(status({true, "/health", "", false}, "", 1000), "503");
  EXPECT_EQ(status({false, "/health", "", true}, ""), "404");
  EXPECT_EQ(status({true, "/", "", true}, ""), "404");
  EXPECT_EQ(status({true, "/metrics", "", true}, ""), "200");
  EXPECT_EQ(status({true, "/metrics", "", false}, ""), "404");
  EXPECT_EQ(status({true, "/metrics", "Bearer ", false}, ""), "404");
  EXPECT_EQ(status({true, "/metrics", "", true}, "secret"), "404");
  EXPECT_EQ(status({true, "/metrics", "Bearer secret", false}, "secret"), "200");
  EXPECT_EQ(status({true, "/metrics", "secret", false}, "secret"), "404");
  EXPECT_EQ(status({true, "/metrics", "", true, "127.0.0.1:8080"}, ""), "200");
  EXPECT_EQ(status({true, "/metrics", "", true, "evil.org:8080"}, ""), "404");
}

TEST(WebPage, FilesAreThoseOfTheFolder) {
  const std::filesystem::path folder = testing::TempDir() + "gicodec_page";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "assets");
  EXPECT_THROW(WebFiles{folder.string()}, tools::Error);  // no index.html
  EXPECT_THROW(WebFiles{(folder / "absent").string()}, tools::Error);
  const auto write = [&](const char* name, std::string_view text) {
    std::ofstream(folder / name) << text;
  };
  write("index.html", "<html>");
  write("assets/a.js", "x");
  const WebFiles files(folder.string());
  const auto ask = [&](const char* path, bool get = true) {
    return web_answer({get, path, "", false}, {}, "", 1, files);
  };
  for (const char* path : {"/", "/index.html"}) {
    EXPECT_EQ(ask(path).rest, "<html>") << path;
    EXPECT_NE(ask(path).head.find("text/html; charset=utf-8"), std::string::npos);
  }
  EXPECT_EQ(ask("/assets/a.js").rest, "x");
  EXPECT_NE(ask("/assets/a.js").head.find("Content-Length: 1\r\n"), std::string::npos);
  for (const char* part : {"script-src 'self' 'wasm-unsafe-eval'",
                           "worker-src 'self' blob:", "frame-ancestors 'none'", "nosniff"}) {
    EXPECT_NE(ask("/").head.find(part), std::string::npos) << part;
  }
  for (const char* path : {"", "index.html", "/assets", "/assets/", "/assets/../index.html",
                           "/../gicodec_page/index.html", "//index.html", "/ASSETS/a.js"}) {
    EXPECT_EQ(ask(path).head.substr(9, 3), "404") << path;
    EXPECT_TRUE(ask(path).rest.empty());
  }
  EXPECT_EQ(ask("/", false).head.substr(9, 3), "404");
  write("assets/a.js.br", "packed");
  WebFiles packed(folder.string());
  packed.add("/scene.glb", "glTF");
  const auto by = [&](const char* path, const char* encodings) {
    return web_answer({true, path, "", false, {}, encodings}, {}, "", 1, packed);
  };
  for (const char* encodings : {"br", "gzip, deflate, br", "br;q=0.5, *"}) {
    EXPECT_EQ(by("/assets/a.js", encodings).rest, "packed") << encodings;
    EXPECT_NE(by("/assets/a.js", encodings).head.find("text/javascript"), std::string::npos);
    EXPECT_NE(by("/assets/a.js", encodings).head.find("Content-Encoding: br\r\n"),
              std::string::npos);
    EXPECT_EQ(by("/", encodings).rest, "<html>");
  }
  for (const char* encodings :
       {"", "gzip", "bread", "br;q=0", "br; q=0.000", "br;q=0.0, gzip", ",,", " "}) {
    EXPECT_EQ(by("/assets/a.js", encodings).rest, "x") << encodings;
    EXPECT_EQ(by("/assets/a.js", encodings).head.find("Content-Encoding"), std::string::npos);
  }
  EXPECT_EQ(by("/scene.glb", "br").rest, "glTF");
  std::filesystem::remove_all(folder);
}

/// Any page can ask a browser to connect to this machine's servers.
TEST(WebPage, OriginsAreChecked) {
  const std::vector<std::string> none, one{"https://example.org"}, all{"*"};
  EXPECT_TRUE(may_connect("", "127.0.0.1:80", none, false));  // no browser
  EXPECT_TRUE(may_connect("http://127.0.0.1:8080", "127.0.0.1:8080", none, false));
  EXPECT_TRUE(may_connect("https://h:8443", "h:8443", none, true));
  // A stranger's name that stands for this machine.
  EXPECT_FALSE(may_connect("http://evil.org:8080", "evil.org:8080", none, false));
  EXPECT_TRUE(may_connect("http://localhost:8080", "localhost:8080", none, false));
  EXPECT_TRUE(may_connect("http://[::1]:8080", "[::1]:8080", none, false));
  for (const char* origin :
       {"http://127.0.0.1:8081", "http://127.0.0.1", "null", "https://", "ftp://127.0.0.1:8080",
        "http://127.0.0.1:8080.evil.org", "https://example.org"}) {
    EXPECT_FALSE(may_connect(origin, "127.0.0.1:8080", none, false)) << origin;
  }
  EXPECT_TRUE(may_connect("https://example.org", "h", one, false));
  EXPECT_FALSE(may_connect("https://example.org:1", "h", one, false));
  EXPECT_FALSE(may_connect("http://example.org", "h", one, false));
  EXPECT_TRUE(may_connect("null", "h", all, false));
}

}  // namespace
}  // namespace gicodec::streaming
