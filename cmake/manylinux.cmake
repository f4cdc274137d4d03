# Wheels for Linux from 2018 on: the clang of PyPI's ziglang, its own libc++ linked in, symbols of glibc
# 2.28 and older. GICODEC_ZIG is the program.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(zig $ENV{GICODEC_ZIG})
set(CMAKE_C_COMPILER ${zig} cc -target x86_64-linux-gnu.2.28)
set(CMAKE_CXX_COMPILER ${zig} c++ -target x86_64-linux-gnu.2.28)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Which instruction sets there are says libgcc, which zig has none of.
execute_process(COMMAND gcc -print-libgcc-file-name OUTPUT_VARIABLE libgcc
                OUTPUT_STRIP_TRAILING_WHITESPACE)
set(CMAKE_CXX_STANDARD_LIBRARIES ${libgcc})
get_filename_component(packages ${CMAKE_CURRENT_LIST_DIR}/../build/manylinux-packages ABSOLUTE)
list(APPEND CMAKE_FIND_ROOT_PATH ${packages}/installed)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${packages}/installed/lib/pkgconfig)
