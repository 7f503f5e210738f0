# outcrop_module(<stage> SOURCES … [DEPS <stages>] [LINK <third parties>] [PUBLIC_LINK <third parties>])
#
# One static library a stage. DEPS names the stages to its left; tests/modules_test.py holds them against the #includes.
function(outcrop_module stage)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPS;LINK;PUBLIC_LINK" ${ARGN})
  add_library(outcrop_${stage} STATIC ${arg_SOURCES})
  add_library(outcrop::${stage} ALIAS outcrop_${stage})
  set_target_properties(outcrop_${stage} PROPERTIES EXPORT_NAME ${stage} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(outcrop_${stage} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(dep IN LISTS arg_DEPS)
    target_link_libraries(outcrop_${stage} PUBLIC outcrop_${dep})
  endforeach()
  target_link_libraries(outcrop_${stage} PUBLIC ${arg_PUBLIC_LINK} PRIVATE ${arg_LINK} $<BUILD_INTERFACE:outcrop_options>)
  set_property(GLOBAL APPEND PROPERTY OUTCROP_STAGES outcrop_${stage})
endfunction()

# outcrop_test(<stage> SOURCES … [LINK …]): one test program a stage, outcrop_<stage>_test.
function(outcrop_test stage)
  cmake_parse_arguments(arg "" "" "SOURCES;LINK" ${ARGN})
  add_executable(outcrop_${stage}_test ${arg_SOURCES})
  target_link_libraries(outcrop_${stage}_test PRIVATE outcrop_${stage} ${arg_LINK} GTest::gtest GTest::gtest_main outcrop_options)
  target_include_directories(outcrop_${stage}_test PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(outcrop_${stage}_test PRIVATE
    OUTCROP_SOURCE_DIR="${PROJECT_SOURCE_DIR}" OUTCROP_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  gtest_discover_tests(outcrop_${stage}_test DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${stage})
endfunction()

# Flags for everything that is ours; not part of the installed interface.
add_library(outcrop_options INTERFACE)
target_compile_features(outcrop_options INTERFACE cxx_std_20)
target_compile_options(outcrop_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wno-psabi -Wno-missing-field-initializers -Wno-restrict -ffp-contract=off)
target_link_options(outcrop_options INTERFACE -Wl,--as-needed)
if(OUTCROP_SANITIZE)
  target_compile_options(outcrop_options INTERFACE -fsanitize=${OUTCROP_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(outcrop_options INTERFACE -fsanitize=${OUTCROP_SANITIZE})
endif()

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_program(OUTCROP_CCACHE ccache)
if(OUTCROP_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${OUTCROP_CCACHE})
endif()
