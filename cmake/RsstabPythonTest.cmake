# SPDX-License-Identifier: Apache-2.0
# The training code runs on the system's Python, for which Debian packages PyTorch and OpenCV;
# -DRSSTAB_PYTHON names another.
find_program(RSSTAB_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH
  DOC "Python that has PyTorch, NumPy and OpenCV")
find_program(RSSTAB_PYTHON NAMES python3)

# rsstab_python_test(FILE TIMEOUT ...): tests/a/b_test.py, a unittest, becomes the ctest `a/b_test`.
# It skips, saying so, where a package that it imports is missing.
function(rsstab_python_test file)
  cmake_parse_arguments(ARG "" "TIMEOUT" "" ${ARGN})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/tests
    OUTPUT_VARIABLE folder)
  get_filename_component(stem ${file} NAME_WE)
  set(name ${folder}/${stem})
  if(NOT name MATCHES "${RSSTAB_TEST_FILTER}" OR NOT RSSTAB_PYTHON)
    return()
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 600)
  endif()
  add_test(NAME ${name}
    COMMAND ${RSSTAB_PYTHON} -B ${PROJECT_SOURCE_DIR}/tests/support/run_unittest.py
      ${CMAKE_CURRENT_SOURCE_DIR}/${file})
  # One thread: more than there are cores only wait for each other.
  set_tests_properties(${name} PROPERTIES LABELS unit TIMEOUT ${ARG_TIMEOUT} SKIP_RETURN_CODE 77
    ENVIRONMENT
      "PYTHONPATH=${PROJECT_SOURCE_DIR}/rsdiff/train:${CMAKE_CURRENT_SOURCE_DIR};OMP_NUM_THREADS=1")
endfunction()
