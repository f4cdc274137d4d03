// Runs a list of things in a child process, so that one that crashes is named and costs only
// itself.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gicodec::test {

/// What a child does: runs all but those that are named, in any order, and tells the name of each
/// before it begins. Returns false if one of them failed.
using Work = std::function<bool(const std::vector<std::string>& but,
                                const std::function<void(std::string_view)>& begins)>;

/// Runs the work in children, which are this program once more with the same arguments, until one
/// comes to its end: what a child died of is not run again. Returns false if anything failed,
/// crashed, or leaked. Called once, before anything else of main() that matters.
[[nodiscard]] bool supervise(char** arguments, const Work& work);

}  // namespace gicodec::test
