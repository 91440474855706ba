# SPDX-License-Identifier: Apache-2.0
# The reference network's stored answers hold to the last bit on the kernels that made them: oneDNN
# and ATen for AVX2, OpenBLAS for the same generation, two threads. Its test weights amplify any
# other rounding ten-thousandfold. (Threads that spin would starve each other on a busy machine.)
set(rsstab_golden_environment
  ONEDNN_MAX_CPU_ISA=AVX2 ATEN_CPU_CAPABILITY=avx2 OPENBLAS_CORETYPE=Haswell
  OMP_NUM_THREADS=2 OPENBLAS_NUM_THREADS=2 OMP_WAIT_POLICY=PASSIVE)
set(rsstab_reference_models ${PROJECT_BINARY_DIR}/tests/reference_models)

# rsstab_golden_kernels(TEST): the test runs on those kernels. Does nothing for a test that the
# filter left out, as the functions below.
function(rsstab_golden_kernels test)
  if(TEST ${test})
    set_property(TEST ${test} APPEND PROPERTY ENVIRONMENT ${rsstab_golden_environment})
  endif()
endfunction()

# rsstab_needs_reference_models(TEST): the test runs with models of the reference kind at hand, whose
# folder it finds in RSSTAB_REFERENCE_MODELS, on those kernels.
function(rsstab_needs_reference_models test)
  if(TEST ${test})
    set_property(TEST ${test} APPEND PROPERTY
      ENVIRONMENT RSSTAB_REFERENCE_MODELS=${rsstab_reference_models})
    set_property(TEST ${test} PROPERTY FIXTURES_REQUIRED rsstab_reference_models)
    rsstab_golden_kernels(${test})
  endif()
endfunction()

# rsstab_reference_models_fixture(NAME): NAME makes the models from checkpoints before the tests that
# need them, NAME_removed removes them (320 MB) after.
function(rsstab_reference_models_fixture name)
  if(NOT RSSTAB_PYTHON OR NOT name MATCHES "${RSSTAB_TEST_FILTER}")
    return()
  endif()
  set(tests ${PROJECT_SOURCE_DIR}/tests/rsdiff)
  add_test(NAME ${name} COMMAND ${RSSTAB_PYTHON} -B ${tests}/data/make_reference_models.py
    ${rsstab_reference_models})
  set_tests_properties(${name} PROPERTIES LABELS unit SKIP_RETURN_CODE 77
    FIXTURES_SETUP rsstab_reference_models
    ENVIRONMENT "PYTHONPATH=${PROJECT_SOURCE_DIR}/rsdiff/train:${tests}/train")
  rsstab_golden_kernels(${name})
  add_test(NAME ${name}_removed COMMAND ${CMAKE_COMMAND} -E rm -rf ${rsstab_reference_models})
  set_tests_properties(${name}_removed PROPERTIES LABELS unit
    FIXTURES_CLEANUP rsstab_reference_models)
endfunction()
