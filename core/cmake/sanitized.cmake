# The libraries again, as objects that end the program at a memory error or undefined behaviour: sanitized_core, … The tests
# of a release build are linked with them, so tests are compiled once. (Preset asan builds everything so, experiments too.)
set(ORTHANT_SANITIZERS -O1 -g1 -UNDEBUG -fno-omit-frame-pointer -fsanitize=address,undefined
    -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr -fno-sanitize-recover=all)

if(ORTHANT_BUILD_TESTS AND CMAKE_BUILD_TYPE STREQUAL "Release")
  foreach(part core solvers integrators)
    add_library(sanitized_${part} OBJECT EXCLUDE_FROM_ALL ${${part}_sources})
    get_target_property(links orthant_${part} LINK_LIBRARIES)
    target_link_libraries(sanitized_${part} PRIVATE ${links})
    target_include_directories(sanitized_${part} PRIVATE "${PROJECT_BINARY_DIR}/include")
    target_compile_features(sanitized_${part} PRIVATE cxx_std_20)
    set_target_properties(sanitized_${part} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    orthant_compile_options(sanitized_${part})
    target_compile_options(sanitized_${part} PRIVATE ${ORTHANT_SANITIZERS})
  endforeach()
endif()
