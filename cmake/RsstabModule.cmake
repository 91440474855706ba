# SPDX-License-Identifier: Apache-2.0
# One private interface target carries the warnings and sanitizers, so that no flag is
# directory-wide and none leaks to users of the installed package.
add_library(rsstab_build_flags INTERFACE)
target_compile_features(rsstab_build_flags INTERFACE cxx_std_20)
target_compile_options(rsstab_build_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  # GCC 12 and 13 see overlapping copies inside std::string that are not there (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${RSSTAB_WARNINGS_AS_ERRORS}>:-Werror>)
if(RSSTAB_SANITIZE)
  target_compile_options(rsstab_build_flags INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(rsstab_build_flags INTERFACE -fsanitize=address,undefined)
  # Under ASan Eigen puts its own header before each block, and so cannot free what an uninstrumented
  # libceres allocated (nor the other way round). malloc is aligned well enough.
  target_compile_definitions(rsstab_build_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
if(RSSTAB_FUZZ)
  target_compile_options(rsstab_build_flags INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)
  target_link_options(rsstab_build_flags INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(rsstab_build_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

# rsstab_module(NAME SOURCES ... PUBLIC ... PRIVATE ...)
# A static library `rsstab_NAME` with alias `rsstab::NAME`. PRIVATE dependencies never reach the
# include path of those who link the module.
function(rsstab_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(rsstab_${name} STATIC ${ARG_SOURCES})
  add_library(rsstab::${name} ALIAS rsstab_${name})
  set_target_properties(rsstab_${name} PROPERTIES
    EXPORT_NAME ${name} OUTPUT_NAME rsstab_${name}
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_compile_features(rsstab_${name} PUBLIC cxx_std_20)
  target_include_directories(rsstab_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/rsstab>)
  target_link_libraries(rsstab_${name} PUBLIC ${ARG_PUBLIC}
    PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:rsstab_build_flags>)
endfunction()

# rsstab_test(FILE LINK ... LABELS ...): tests/a/b_test.cc becomes the ctest `a/b_test`.
# Every GoogleTest case stays visible in one ctest entry; a run without any executed case is a skip.
function(rsstab_test file)
  cmake_parse_arguments(ARG "" "TIMEOUT" "LINK;LABELS" ${ARGN})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/tests
    OUTPUT_VARIABLE folder)
  get_filename_component(stem ${file} NAME_WE)
  if(NOT "${folder}/${stem}" MATCHES "${RSSTAB_TEST_FILTER}")
    return()
  endif()
  string(REPLACE "/" "_" target "${folder}_${stem}")
  add_executable(${target} ${file})
  target_link_libraries(${target} PRIVATE ${ARG_LINK} rsstab_test_support GTest::gmock GTest::gtest
    rsstab_build_flags)
  add_test(NAME ${folder}/${stem} COMMAND ${target})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if("slow" IN_LIST ARG_LABELS)
    set_tests_properties(${folder}/${stem} PROPERTIES COST 100)  # starts first, beside the quick ones
  endif()
  set_tests_properties(${folder}/${stem} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT}
    SKIP_REGULAR_EXPRESSION "\\[  PASSED  \\] 0 tests\\.")
endfunction()
