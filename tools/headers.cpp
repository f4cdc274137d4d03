// Nothing: the headers of tools/CMakeLists.txt are compiled with it.
