# WebAssembly: Debian's Emscripten, the packages that script/cross builds for it, programs run by Node.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_CXX_FLAGS_INIT -fwasm-exceptions)
# Tests return a status, read files and need more than the first 16 MB.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-O1 -sEXIT_RUNTIME=1 -sALLOW_MEMORY_GROWTH=1 -sNODERAWFS=1")
set(CMAKE_CROSSCOMPILING_EMULATOR node --no-experimental-fetch)
get_filename_component(packages ${CMAKE_CURRENT_LIST_DIR}/../build/wasm-packages/installed ABSOLUTE)
list(APPEND CMAKE_FIND_ROOT_PATH ${packages})
set(ENV{PKG_CONFIG_LIBDIR} ${packages}/lib/pkgconfig)
