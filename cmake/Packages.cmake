# What `cpack` makes of the preset "packages" (docs/building.md): Debian packages, apart by what links
# and loads what, and a .tar.gz of everything.
#   libgicodecX.Y     the shared library: C, and C++ of the same compiler
#   libgicodec-dev    headers, CMake and pkg-config files, pages, examples
#   gicodec           the programs and their manual pages
#   gicodec-hevc      HEVC for both; alone because x265 is GPL
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(CPACK_GENERATOR "DEB;TGZ")
if(WIN32)
  set(CPACK_GENERATOR ZIP)  # of everything, with the licences of what is linked into the programs
  foreach(package libopenexr-dev libimath-dev libfmt-dev nlohmann-json3-dev libcli11-dev libz-mingw-w64-dev
          gcc-mingw-w64-x86-64-posix-runtime mingw-w64-x86-64-dev)
    install(FILES /usr/share/doc/${package}/copyright RENAME ${package}
            DESTINATION ${CMAKE_INSTALL_DOCDIR}/licences COMPONENT tools)
  endforeach()
endif()
set(CPACK_PACKAGE_NAME gicodec)
set(CPACK_PACKAGE_VENDOR "the libgicodec authors")
set(CPACK_PACKAGE_CONTACT "the libgicodec authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENT_RUNTIME_GROUP runtime)
set(CPACK_COMPONENT_DEV_GROUP dev)
set(CPACK_COMPONENT_TOOLS_GROUP tools)
set(CPACK_COMPONENT_SERVICE_GROUP tools)
set(CPACK_COMPONENT_HEVC_GROUP hevc)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What one package has, another may need.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/src
    ${PROJECT_BINARY_DIR}/src/backend/hevc)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
foreach(part RUNTIME DEV TOOLS HEVC)
  set(CPACK_DEBIAN_${part}_PACKAGE_NAME gicodec)
endforeach()
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libgicodec${abi})
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libgicodec-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libgicodec${abi} (= ${PROJECT_VERSION}), libzstd-dev, liblz4-dev, libxxhash-dev")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS gicodec-hevc)
set(CPACK_DEBIAN_HEVC_PACKAGE_NAME gicodec-hevc)
set(CPACK_DEBIAN_HEVC_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "The shared library.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers in C and C++, for programs that link the library.")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "The programs: gicodec, and gi-trace, gi-render, gi-server, gi-client.")
set(CPACK_COMPONENT_HEVC_DESCRIPTION "The HEVC backend, by x265, libde265 and FFmpeg.")
include(CPack)
