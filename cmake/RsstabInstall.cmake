# SPDX-License-Identifier: Apache-2.0
# The library with its CMake package `rsstab`, the program, its manual and shell completion.

# Media I/O is the program's own business: a host of the library brings its frames.
set(rsstab_installed_modules rsstab_base rsstab_igf rsstab_rsdiff rsstab_stabilizer rsstab_pipeline)
set(rsstab_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rsstab)
install(TARGETS ${rsstab_installed_modules} EXPORT rsstabTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT rsstabTargets NAMESPACE rsstab:: DESTINATION ${rsstab_package_dir}
  COMPONENT development)
configure_package_config_file(cmake/rsstabConfig.cmake.in
  ${PROJECT_BINARY_DIR}/rsstabConfig.cmake INSTALL_DESTINATION ${rsstab_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/rsstabConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rsstabConfig.cmake ${PROJECT_BINARY_DIR}/rsstabConfigVersion.cmake
  DESTINATION ${rsstab_package_dir} COMPONENT development)
# Headers that need Ceres or carry an implementation stay inside.
install(DIRECTORY igf rsdiff stabilizer DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rsstab
  COMPONENT development FILES_MATCHING PATTERN "*.h"
  PATTERN "street" EXCLUDE PATTERN "models" EXCLUDE PATTERN "train" EXCLUDE
  PATTERN "*_residuals.h" EXCLUDE PATTERN "*_detail.h" EXCLUDE)

# The C interface stands alone: hosts need neither the static libraries nor what they are built with.
install(TARGETS rsstab_capi EXPORT rsstabCapiTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
  NAMELINK_COMPONENT development)
install(EXPORT rsstabCapiTargets NAMESPACE rsstab:: DESTINATION ${rsstab_package_dir}
  COMPONENT development)
install(FILES plugin/capi/rsstab.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
configure_file(cmake/rsstab.pc.in ${PROJECT_BINARY_DIR}/rsstab.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/rsstab.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
  COMPONENT development)

set(rsstab_docs ${PROJECT_BINARY_DIR}/generated/docs)
file(MAKE_DIRECTORY ${rsstab_docs})
add_custom_command(
  OUTPUT ${rsstab_docs}/rs-stabilize.1 ${rsstab_docs}/rs-stabilize
  COMMAND rs-stabilize --print-manual > ${rsstab_docs}/rs-stabilize.1
  COMMAND rs-stabilize --print-bash-completion > ${rsstab_docs}/rs-stabilize
  DEPENDS rs-stabilize VERBATIM
  COMMENT "Writing manual page and shell completion")
add_custom_target(rsstab_docs ALL
  DEPENDS ${rsstab_docs}/rs-stabilize.1 ${rsstab_docs}/rs-stabilize)
install(TARGETS rs-stabilize COMPONENT program)
install(FILES ${rsstab_docs}/rs-stabilize.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1
  COMPONENT program)
install(FILES ${rsstab_docs}/rs-stabilize
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
# For those who build FFmpeg: the native filter as source, with the scripts that add and build it.
set(rsstab_ffmpeg_dir ${CMAKE_INSTALL_DATADIR}/rs-stabilize/ffmpeg)
install(FILES plugin/ffmpeg/vf_rsstabilize.c DESTINATION ${rsstab_ffmpeg_dir} COMPONENT development)
install(PROGRAMS plugin/ffmpeg/add_to_ffmpeg.sh plugin/ffmpeg/build_ffmpeg.sh
  DESTINATION ${rsstab_ffmpeg_dir} COMPONENT development)
