# What keeps a fault from becoming an attacker's tool, in every target of this project: canaries and
# probes on the stack, checked string functions and containers, indirect branches that land where they
# may, read-only relocations, programs at random addresses. tests/hardening.sh looks for each of them in
# what was built; SECURITY.md tells of it.
option(GICODEC_HARDEN "Build with what the compiler has against attacks" ON)
if(NOT GICODEC_HARDEN)
  return()
endif()
if(MSVC)
  add_compile_options(/guard:cf)
  add_link_options(/guard:cf)
  return()
endif()
add_compile_definitions(_GLIBCXX_ASSERTIONS)
if(GICODEC_SANITIZE)
  return()  # which looks for more, and is not what ships
endif()

include(CheckCXXCompilerFlag)
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

add_compile_options(-fstack-protector-strong)
if(WIN32)
  add_link_options(-fstack-protector-strong)  # a library there
endif()
set(flags -fcf-protection=full)
if(NOT WIN32)  # where GCC 12 cannot (and the system's own calls probe the stack)
  list(APPEND flags -fstack-clash-protection)
endif()
foreach(flag IN LISTS flags)
  string(MAKE_C_IDENTIFIER "GICODEC_HAS${flag}" has)
  check_cxx_compiler_flag(${flag} ${has})
  if(${has})
    add_compile_options(${flag})
  endif()
endforeach()
# Without optimisation there are no such checks.
set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
add_compile_options("$<${optimised}:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>")
if(NOT WIN32 AND NOT APPLE)  # whose linkers do the like by themselves
  add_link_options(-Wl,-z,relro,-z,now,-z,noexecstack)
endif()
