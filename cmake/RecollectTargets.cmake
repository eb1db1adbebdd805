# How this project declares its libraries and tests: one static library and one test program a
# module. Warnings are errors on our own code only; other people's headers come in as system ones.
include(GoogleTest)

add_library(recollect_flags INTERFACE)
target_compile_options(recollect_flags INTERFACE -Wall -Wextra -Wconversion -Werror)
if(RECOLLECT_SANITIZE)
  target_compile_options(recollect_flags INTERFACE -fsanitize=address,undefined
                                                   -fno-omit-frame-pointer -O1 -g1)
  target_link_options(recollect_flags INTERFACE -fsanitize=address,undefined)
endif()

# recollect_library(NAME SOURCES a.cc ... [DEPENDS public targets ...] [PRIVATE targets ...])
function(recollect_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  add_library(recollect_${name} STATIC ${ARG_SOURCES})
  target_include_directories(recollect_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src)
  target_link_libraries(recollect_${name} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE}
                                                                        recollect_flags)
endfunction()

# recollect_test(NAME SOURCES a_test.cc ... [DEPENDS targets ...] [LABEL label]): ctest lists each
# case on its own, run from the top of the checkout: RECOLLECT_SHARED_DATA, where the measuring data
# lies if it is there at all, is relative to that.
function(recollect_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} GTest::gtest_main recollect_flags)
  target_compile_definitions(${name} PRIVATE
    RECOLLECT_SHARED_DATA="../shared/data")
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       WORKING_DIRECTORY ${CMAKE_SOURCE_DIR}
                       PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT})
endfunction()
