// What is told of connections over WebSockets if memory is short.
#include "faults/faults.h"
#include "stream/web_state.h"

#include <gtest/gtest.h>

#include <memory>
#include <new>

namespace gicodec::streaming {
namespace {

/// The caller waits for the end of each connection that it knows.
TEST(WebFaults, EndsAreToldWithoutMemory) {
  for (const bool lasting : {false, true}) {
    WebState state{NetOptions()};
    WebLink* const link = state.add(std::make_unique<WebLink>());
    test::Fault fault(0, 1, lasting);
    fault([&] {
      state.closed(link, true, {"a reason of so many letters that ", "it needs memory"}, true);
      return 0;
    });
    EXPECT_TRUE(fault.failed());
    ASSERT_EQ(state.events.size(), 1U);
    EXPECT_EQ(state.events.front().type, NetEvent::Type::closed);
    EXPECT_EQ(state.events.front().link.web, link);
    EXPECT_TRUE(state.events.front().final);
  }
}

TEST(WebFaults, WhoBreaksARuleIsToldOfLater) {
  WebState state{NetOptions()};
  WebLink* const link = state.add(std::make_unique<WebLink>());
  test::Fault fault(0, 1, false);
  const bool thrown = fault([&] {
    try {
      state.refuse(link, Reason::flood);
    } catch (const std::bad_alloc&) {
      return true;
    }
    return false;
  });
  EXPECT_TRUE(thrown);
  EXPECT_FALSE(link->broken);
  state.refuse(link, Reason::flood);
  EXPECT_TRUE(link->broken);
  ASSERT_EQ(state.events.size(), 1U);
  EXPECT_EQ(state.events.front().reason, Reason::flood);
}

}  // namespace
}  // namespace gicodec::streaming
