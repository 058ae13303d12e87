# Compiler settings and the few functions with which the rooms declare their targets.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

set(SCENEGEN_SANITIZE "" CACHE STRING "Sanitizers, as for -fsanitize=")
option(SCENEGEN_COVERAGE "Build with coverage counters" OFF)
option(SCENEGEN_FUZZ "Build the libFuzzer targets (clang only)" OFF)

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

add_library(scenegen_settings INTERFACE)
# -ffp-contract=off: the same bytes from every compiler and on every processor (no fused multiply-add behind our back).
target_compile_options(scenegen_settings INTERFACE -ffp-contract=off
  -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror)
target_compile_definitions(scenegen_settings INTERFACE GLM_FORCE_XYZW_ONLY GLM_ENABLE_EXPERIMENTAL
  SCENEGEN_VERSION="${PROJECT_VERSION}")
target_include_directories(scenegen_settings INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 reports false positives of these in the standard library at -O2 and -O3 (GCC bugs 105329, 105651, 107852).
  target_compile_options(scenegen_settings INTERFACE -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(CMAKE_UNITY_BUILD)  # in builds that only CI makes, and others seldom: a fifth of the compile time
  # What is local to one file hides what is local to another; the release build, of single files, has the warning.
  target_compile_options(scenegen_settings INTERFACE -Wno-shadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")  # says so of types of an anonymous namespace in whatever is included
    target_compile_options(scenegen_settings INTERFACE -Wno-subobject-linkage)
  endif()
endif()
if(SCENEGEN_SANITIZE)
  add_compile_options(-fsanitize=${SCENEGEN_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${SCENEGEN_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(scenegen_settings INTERFACE -Wno-maybe-uninitialized)  # false positives under -fsanitize
  endif()
endif()
if(SCENEGEN_COVERAGE)
  add_compile_options(--coverage)
  add_link_options(--coverage)
endif()
if(SCENEGEN_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Sanitizers watch the code under test; that which calls it is a third of the whole build (560 of 1785 s of processor time) when
# it is optimized as well, and a third less when not.
function(scenegen_unoptimized_when_sanitized target)
  if(SCENEGEN_SANITIZE)
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# In unity builds the files of a folder are compiled as one, so names that are local to a file are to differ within a folder. Others
# are split by `prefixes` of the file's path: those of which one part opens the namespace of another part.
function(scenegen_unity target prefixes)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    get_filename_component(group "./${source}" DIRECTORY)
    foreach(prefix ${prefixes})
      string(FIND ${source} ${prefix} place)
      if(place EQUAL 0)
        set(group ${prefix})
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER "${group}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()

# scenegen_library(scene SOURCES a.cpp … LIBRARIES … UNITY_PREFIXES …): the static library of a room, target scenegen_<name>.
function(scenegen_library name)
  cmake_parse_arguments(A "" "" "SOURCES;LIBRARIES;UNITY_PREFIXES" ${ARGN})
  add_library(scenegen_${name} STATIC ${A_SOURCES})
  target_link_libraries(scenegen_${name} PUBLIC scenegen_settings ${A_LIBRARIES})
  scenegen_unity(scenegen_${name} "${A_UNITY_PREFIXES}")
endfunction()

# scenegen_program(scenegen SOURCES … LIBRARIES …): a program in build/<preset>/bin.
function(scenegen_program name)
  cmake_parse_arguments(A "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  target_link_libraries(${name} PRIVATE scenegen_settings ${A_LIBRARIES})
  scenegen_unity(${name} "")
endfunction()

# scenegen_test(timeline/curves SOURCES curves_test.cpp LIBRARIES …): a Catch2 program, one ctest entry. Tests that need neither
# Vulkan nor long carry the label `sanitized` and belong to the target sanitized_tests: CI runs them under ASan and UBSan too.
function(scenegen_test name)
  cmake_parse_arguments(A "" "" "SOURCES;LIBRARIES;LABELS;ARGUMENTS" ${ARGN})
  string(REPLACE "/" "_" target test_${name})
  add_executable(${target} ${A_SOURCES})
  target_link_libraries(${target} PRIVATE scenegen_settings scenegen_test_main ${A_LIBRARIES})
  scenegen_unoptimized_when_sanitized(${target})
  add_test(NAME ${name} COMMAND ${target} ${A_ARGUMENTS})
  if(NOT name MATCHES "^render/|sceneplay" AND NOT A_LABELS)
    set(A_LABELS sanitized)
    add_dependencies(sanitized_tests ${target})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${A_LABELS}" TIMEOUT 600)
endfunction()
