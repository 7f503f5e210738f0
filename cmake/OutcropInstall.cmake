# install(): programs, static libraries, headers, data, and a package that find_package(outcrop) finds.
include(CMakePackageConfigHelpers)

get_property(OUTCROP_STAGES GLOBAL PROPERTY OUTCROP_STAGES)
set(OUTCROP_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/outcrop)

install(TARGETS ${OUTCROP_STAGES} EXPORT outcropTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(program amplify polygonize)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/outcrop DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
foreach(folder reliefs strata schemas)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/outcrop
    PATTERN "*.py" EXCLUDE PATTERN "__pycache__" EXCLUDE)
endforeach()

# What the static libraries need in turn: each line a target and the package that defines it.
set(packages
  glm::glm glm
  TBB::tbb "TBB CONFIG"
  OpenImageIO::OpenImageIO "OpenImageIO MODULE"
  TIFF::TIFF TIFF
  embree "embree 3 CONFIG"
  OpenVDB::openvdb "OpenVDB MODULE"
  meshoptimizer::meshoptimizer "meshoptimizer CONFIG")
set(linked "")
foreach(stage IN LISTS OUTCROP_STAGES)
  get_target_property(links ${stage} INTERFACE_LINK_LIBRARIES)
  string(APPEND linked ";${links};")
endforeach()
set(OUTCROP_DEPENDENCIES "")
while(packages)
  list(POP_FRONT packages target package)
  if(linked MATCHES "[;:>]${target}[;>]")
    string(APPEND OUTCROP_DEPENDENCIES "find_dependency(${package})\n")
  endif()
endwhile()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/outcropConfig.cmake.in
  ${PROJECT_BINARY_DIR}/outcropConfig.cmake INSTALL_DESTINATION ${OUTCROP_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/outcropConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/outcropConfig.cmake ${PROJECT_BINARY_DIR}/outcropConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindOpenImageIO.cmake DESTINATION ${OUTCROP_PACKAGE_DIR})
install(EXPORT outcropTargets NAMESPACE outcrop:: DESTINATION ${OUTCROP_PACKAGE_DIR})
