# Installation: the program with man pages and completion, the library with its headers and CMake package, and the
# licences.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/moiregauge)

# The program itself writes its man pages and completion.
file(GLOB page_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/cli/*.md)
set(words_dir ${PROJECT_BINARY_DIR}/words)
set(word_commands)
set(word_files)
foreach(page IN LISTS page_files)
  get_filename_component(name ${page} NAME_WE)
  set(title moiregauge-${name})
  if(name STREQUAL moiregauge)
    set(title moiregauge)
  endif()
  list(APPEND word_commands COMMAND moiregauge help --man ${name} > ${words_dir}/man/${title}.1)
  list(APPEND word_commands COMMAND gzip -9nf ${words_dir}/man/${title}.1)
  list(APPEND word_files ${words_dir}/man/${title}.1.gz)
endforeach()
add_custom_command(
  OUTPUT ${word_files} ${words_dir}/bash/moiregauge ${words_dir}/zsh/_moiregauge
  COMMAND ${CMAKE_COMMAND} -E make_directory ${words_dir}/man ${words_dir}/bash ${words_dir}/zsh
  ${word_commands}
  COMMAND moiregauge completion bash > ${words_dir}/bash/moiregauge
  COMMAND moiregauge completion zsh > ${words_dir}/zsh/_moiregauge
  DEPENDS moiregauge
  COMMENT "Man pages and completion"
  VERBATIM)
# Part of each build that may be installed. Builds with sanitizers or fuzzing do not need them.
set(with_all ALL)
if(MOIREGAUGE_SANITIZE OR MOIREGAUGE_FUZZ OR MOIREGAUGE_TSAN)
  set(with_all)
endif()
add_custom_target(words ${with_all} DEPENDS ${word_files} ${words_dir}/bash/moiregauge ${words_dir}/zsh/_moiregauge)

install(TARGETS moiregauge RUNTIME COMPONENT program)
install(FILES ${word_files} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${words_dir}/bash/moiregauge DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
install(FILES ${words_dir}/zsh/_moiregauge DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/examples/read_moiregauge.py ${PROJECT_SOURCE_DIR}/examples/read_moiregauge.m
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge/examples COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge COMPONENT program)

# The library: the public headers, the shared library with its decoding program, and the static part for phases. Nothing
# else is installed.
install(TARGETS moiregauge_library EXPORT moiregauge-targets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT dev
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS moiregauge_sampling_moire EXPORT moiregauge-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS moiregauge_decode RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/moiregauge COMPONENT library)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmoiregauge${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
        COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/moiregauge DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(FILES ${PROJECT_BINARY_DIR}/generated/moiregauge/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/moiregauge
        COMPONENT dev)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/cmake DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge-dev/examples
        COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge-dev COMPONENT dev)
install(EXPORT moiregauge-targets NAMESPACE moiregauge:: DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(cmake/moiregauge-config.cmake.in ${PROJECT_BINARY_DIR}/moiregauge-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before version 1 any minor version may change the library.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/moiregauge-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/moiregauge-config.cmake ${PROJECT_BINARY_DIR}/moiregauge-config-version.cmake
        DESTINATION ${package_dir} COMPONENT dev)

# The Python module, where Debian's Python finds it.
if(MOIREGAUGE_PYTHON_MODULE)
  set(python_destination lib/python3/dist-packages/moiregauge)
  install(TARGETS moiregauge_python LIBRARY DESTINATION ${python_destination} COMPONENT python)
  install(FILES ${python_files} DESTINATION ${python_destination} COMPONENT python)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-moiregauge COMPONENT python)
endif()

# The pages, with their pictures and notebooks.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge-doc COMPONENT doc)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/cmake/copyright
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/moiregauge-doc COMPONENT doc)
