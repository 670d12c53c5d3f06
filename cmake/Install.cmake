# Installing, and the package that a stranger's project finds: find_package(sherd), sherd::sherd.
include(CMakePackageConfigHelpers)

install(TARGETS sherd EXPORT sherdTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS sherd_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS sherd_assimp RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/sherd)
install(DIRECTORY include/sherd DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES docs/manifest.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/sherd)
install(FILES LICENSE README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Debian's copyright file: the sources' license, and that of the program as it is linked.
set(copyright ${PROJECT_BINARY_DIR}/copyright)
file(READ cmake/copyright.in copyright_text)
if(SHERD_GPL)
  file(READ cmake/copyright-gpl.in gpl_text)
  string(APPEND copyright_text "\n${gpl_text}")
endif()
file(CONFIGURE OUTPUT ${copyright} CONTENT "${copyright_text}" @ONLY)
install(FILES ${copyright} DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/sherd)
install(EXPORT sherdTargets NAMESPACE sherd:: DESTINATION ${package})
configure_package_config_file(cmake/sherdConfig.cmake.in ${PROJECT_BINARY_DIR}/sherdConfig.cmake
  INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sherdConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sherdConfig.cmake ${PROJECT_BINARY_DIR}/sherdConfigVersion.cmake
  cmake/SherdDependencies.cmake DESTINATION ${package})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Sherd developers <sherd@localhost>")
set(CPACK_PACKAGE_VENDOR "Sherd")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "ocl-icd-libopencl1 | libopencl1, libhdf5-103-1, libopenvdb-dev")
set(CPACK_STRIP_FILES ON)
include(CPack)
