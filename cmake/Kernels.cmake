# Instruction sets, and sources that are compiled once for each (simd/dispatch.h).

# The sets of each architecture, each including those before it. Engines that know no vectors refuse
# all of a WebAssembly module that has them: for these it is built with scalar alone.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(isas scalar sse4 avx2 avx512)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64|ARM64")
  set(isas scalar neon)
elseif(EMSCRIPTEN)
  set(isas scalar simd128)
else()
  set(isas scalar)
endif()
set(GICODEC_ISAS "${isas}" CACHE STRING "Instruction sets that kernels are built for, ascending")
list(JOIN GICODEC_ISAS "," gicodec_isas)  # as sources read them
# What each set may use is what simd/isa.cpp looks for in the processor.
set(sse4_flags -msse4.1)
set(avx2_flags -mavx2 -mbmi2)
set(avx512_flags ${avx2_flags} -mavx512f -mavx512bw -mavx512cd -mavx512dq -mavx512vl -mavx512vbmi
    -mavx512vbmi2 -mprefer-vector-width=512)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns about undefined registers in its own AVX-512 headers.
  list(APPEND avx512_flags -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
set(simd128_flags -msimd128)
if(MSVC AND CMAKE_CXX_COMPILER_ID STREQUAL "MSVC")
  message(FATAL_ERROR "Kernels need vector extensions of clang: configure with -T ClangCL, or use the DLL")
endif()

# gicodec_kernels(NAME SOURCES...): compiles them once per set, as objects NAME_SET, and lists these in
# NAME_kernels.
function(gicodec_kernels name)
  foreach(isa IN LISTS GICODEC_ISAS)
    set(objects ${name}_${isa})
    add_library(${objects} OBJECT ${ARGN})
    target_compile_definitions(${objects} PRIVATE GICODEC_ISAS=${gicodec_isas} GICODEC_ISA=${isa}
      GICODEC_VECTORS="simd/vector_${isa}.inl")
    target_compile_options(${objects} PRIVATE ${${isa}_flags}
      # Checks of every element in the innermost loops; what goes in is checked before (HACKING.md).
      -U_GLIBCXX_ASSERTIONS)
    if(NOT GICODEC_SMALL)
      target_compile_options(${objects} PRIVATE $<$<CONFIG:MinSizeRel>:-O2>)
    endif()
    if(GICODEC_SANITIZE)
      # Take compilers half of their time, to see less of the same than bounds and AddressSanitizer.
      target_compile_options(${objects} PRIVATE -fno-sanitize=object-size,null,pointer-overflow)
    endif()
    if(isa STREQUAL scalar OR
       (GICODEC_SANITIZE AND (NOT GICODEC_ALL_TESTS OR GICODEC_SANITIZE STREQUAL "thread")))
      # Not all inlined, which takes compilers a quarter of their time. Values of scalar go through memory
      # in any case.
      target_compile_definitions(${objects} PRIVATE GICODEC_SMALL)
    endif()
    if(GICODEC_FUZZ)
      # They run half as fast if every comparison of a texel is reported to the fuzz engine.
      target_compile_options(${objects} PRIVATE -fno-sanitize-coverage=trace-cmp)
    endif()
    target_compile_features(${objects} PRIVATE cxx_std_20)
    target_include_directories(${objects} PRIVATE
      ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(${objects} PRIVATE gicodec_flags)
    set_target_properties(${objects} PROPERTIES
      UNITY_BUILD OFF POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden)
    list(APPEND kernels $<TARGET_OBJECTS:${objects}>)
  endforeach()
  set(${name}_kernels ${kernels} CACHE INTERNAL "")
endfunction()
