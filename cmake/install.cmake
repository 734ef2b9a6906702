# What `cmake --install` puts below the prefix: the program, the rooms below app as libraries for
# find_package(grainlaw), and the documentation. Nothing in it names this source tree or the prefix.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(installed_headers ${CMAKE_INSTALL_INCLUDEDIR}/grainlaw)  # "dem/engine/packing.hpp" is found in there
set(installed_package ${CMAKE_INSTALL_LIBDIR}/cmake/grainlaw)

foreach(room IN ITEMS model dem fit predict chain)
  set_target_properties(grainlaw_${room} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS grainlaw_${room} EXPORT grainlaw-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    INCLUDES DESTINATION ${installed_headers})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room}/ DESTINATION ${installed_headers}/${room}
    FILES_MATCHING PATTERN *.hpp PATTERN "*-inl.hpp" EXCLUDE)
endforeach()
install(EXPORT grainlaw-targets NAMESPACE grainlaw:: DESTINATION ${installed_package})

install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)  # app/CMakeLists.txt

list(JOIN sundials_components " " sundials_components_text)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/grainlaw-config.cmake.in
  ${PROJECT_BINARY_DIR}/grainlaw-config.cmake INSTALL_DESTINATION ${installed_package}
  NO_SET_AND_CHECK_MACRO)
# Below 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/grainlaw-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/grainlaw-config.cmake ${PROJECT_BINARY_DIR}/grainlaw-config-version.cmake
  DESTINATION ${installed_package})

install(TARGETS grainlaw RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)

# The Python package, where Debian's interpreter looks below /usr.
set(GRAINLAW_PYTHON_DIR lib/python3/dist-packages CACHE STRING "Folder of Python packages, below the prefix")
if(GRAINLAW_PYTHON)
  install(TARGETS grainlaw_python LIBRARY DESTINATION ${GRAINLAW_PYTHON_DIR}/grainlaw COMPONENT python)
  install(DIRECTORY python/grainlaw DESTINATION ${GRAINLAW_PYTHON_DIR} COMPONENT python
    FILES_MATCHING PATTERN *.py PATTERN *.pyi PATTERN py.typed PATTERN __pycache__ EXCLUDE)
endif()

# As in the source tree, so that links between the pages hold; the schemas of the input files are in docs/schemas.
install(FILES README.md CHANGELOG.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# cpack -G DEB: the program with completions, manual and documentation; the Python package; the libraries are for those who
# build.
set(CPACK_PACKAGE_CONTACT "the authors of CITATION.cff <grainlaw@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME grainlaw)
if(GRAINLAW_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-grainlaw)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  math(EXPR next_minor "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_minor}), python3-numpy")
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
include(CPack)
