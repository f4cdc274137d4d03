// Three things of which the second crashes: it is named, and the third is run all the same.
#include "supervisor.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

int main(int, char** argv) {
  const bool good = gicodec::test::supervise(argv, [](const auto& but, const auto& begins) {
    for (const char* name : {"first", "second", "third"}) {
      if (std::find(but.begin(), but.end(), name) != but.end()) continue;
      begins(name);
      if (name[0] == 's') std::abort();
      std::printf("ran %s\n", name);
    }
    return true;
  });
  std::printf("%s\n", good ? "all good" : "not all good");
  return 0;
}
