# Finds OpenImageIO without its own CMake config, which on Debian 12 asks for tools and OpenCV headers that nobody needs.
#
# Defines the target OpenImageIO::OpenImageIO and OpenImageIO_FOUND, OpenImageIO_VERSION.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util)
find_path(OpenImageIO_Imath_INCLUDE_DIR ImathVec.h PATH_SUFFIXES Imath)  # its headers include Imath's
mark_as_advanced(OpenImageIO_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_Imath_INCLUDE_DIR)

if(OpenImageIO_INCLUDE_DIR AND EXISTS "${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h")
  file(STRINGS "${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h" _oiio_lines
    REGEX "^#define OIIO_VERSION_(MAJOR|MINOR|PATCH)[ \t]+[0-9]+")
  string(REGEX REPLACE "[^0-9;]" "" OpenImageIO_VERSION "${_oiio_lines}")
  string(REPLACE ";" "." OpenImageIO_VERSION "${OpenImageIO_VERSION}")
  unset(_oiio_lines)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
  REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_INCLUDE_DIR OpenImageIO_Imath_INCLUDE_DIR
  VERSION_VAR OpenImageIO_VERSION)

if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::OpenImageIO UNKNOWN IMPORTED GLOBAL)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION "${OpenImageIO_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR};${OpenImageIO_Imath_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${OpenImageIO_Util_LIBRARY}")
endif()
