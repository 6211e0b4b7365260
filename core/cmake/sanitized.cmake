# orthant_add_sanitized(targets…): each once more as objects, sanitized_TARGET. A release build's tests are linked with
# them, so that tests are compiled once. (Preset asan builds everything so.) Called where the targets are made:
# properties of sources hold in one folder.
# orthant_sanitize(target): it ends the program at a memory error or undefined behaviour, and checks Eigen's sizes.
function(orthant_sanitize target)
  target_compile_options(${target} PRIVATE -O1 -g1 -fno-omit-frame-pointer
    -include "${PROJECT_SOURCE_DIR}/tests/support/eigen_assert.h" -fsanitize=address,undefined
    -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr -fno-sanitize-recover=all)
  # Eigen takes memory otherwise where it sees a sanitizer; the tests' objects, which free it, do not.
  target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endfunction()

function(orthant_add_sanitized)
  if(NOT ORTHANT_BUILD_TESTS OR NOT CMAKE_BUILD_TYPE STREQUAL "Release")
    return()
  endif()
  foreach(target ${ARGN})
    get_target_property(sources ${target} SOURCES)
    add_library(sanitized_${target} OBJECT EXCLUDE_FROM_ALL ${sources})
    foreach(property LINK_LIBRARIES INCLUDE_DIRECTORIES COMPILE_DEFINITIONS)
      get_target_property(values ${target} ${property})
      if(values)
        set_target_properties(sanitized_${target} PROPERTIES ${property} "${values}")
      endif()
    endforeach()
    target_compile_features(sanitized_${target} PRIVATE cxx_std_20)
    orthant_compile_options(sanitized_${target})
    orthant_sanitize(sanitized_${target})
  endforeach()
endfunction()
