# Run by the build for a program of tests: writes OUTPUT, which tells ctest of each suite in PROGRAM.
#   cmake -D PROGRAM=... -D EMULATOR=... -D LABEL=... -D OUTPUT=... -P AddSuites.cmake
execute_process(COMMAND ${EMULATOR} ${PROGRAM} --gtest_list_tests
                OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY TIMEOUT 60)
string(REGEX MATCHALL "(^|\n)[^ \n][^\n]*" suites "${listed}")
set(text "")
foreach(suite IN LISTS suites)
  if(suite MATCHES "^\n?([^ ]+)[.]( |$)")
    set(suite ${CMAKE_MATCH_1})
    string(APPEND text "add_test([==[${suite}]==] ${EMULATOR} [==[${PROGRAM}]==] [==[--gtest_filter=${suite}.*]==])\n"
           "set_tests_properties([==[${suite}]==] PROPERTIES LABELS [==[${LABEL}]==])\n")
  endif()
endforeach()
if(text STREQUAL "")
  message(FATAL_ERROR "${PROGRAM} lists no test")
endif()
file(WRITE "${OUTPUT}" "${text}")
