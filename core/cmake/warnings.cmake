# orthant_compile_options(target): the one set of warnings and numerical flags, private to Orthant's own sources.
# Libraries found elsewhere are imported targets, hence system headers: their warnings are theirs.
set(orthant_warnings
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor
  -Woverloaded-virtual -Wdouble-promotion -Wformat=2 -Wimplicit-fallthrough -Wcast-align -Wcast-qual
  -Wextra-semi -Wundef -Wunused)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND orthant_warnings -Wduplicated-cond -Wlogical-op)
  # GCC 12 guesses these after inlining, inside Eigen as well, and guesses wrong; missing fields of a designated
  # initializer are our way of taking defaults.
  # And a file that a unity build includes is no header.
  list(APPEND orthant_warnings -Wno-subobject-linkage)
  list(APPEND orthant_warnings -Wno-maybe-uninitialized -Wno-array-bounds -Wno-restrict -Wno-missing-field-initializers)
else()
  list(APPEND orthant_warnings -Wno-double-promotion)  # of clang: of double to long double too, which loses nothing
endif()

# -ffp-contract=off, no -ffast-math, no -march=native: the compiler neither fuses nor reorders arithmetic, so the same
# build gives the same bits run after run. (The C library's sin and cos and the BLAS may still differ between machines.)
# -fno-semantic-interposition: code that Python can load is inlined as in a program.
# -falign-…: a step takes the same wherever its functions come to lie; changes elsewhere moved it by 2 to 4 % (bare_loop).
function(orthant_compile_options target)
  target_compile_options(${target} PRIVATE ${orthant_warnings} -ffp-contract=off -fno-semantic-interposition
                         $<$<CXX_COMPILER_ID:GNU>:-falign-functions=64> $<$<CXX_COMPILER_ID:GNU>:-falign-loops=32>
                         $<$<BOOL:${ORTHANT_WERROR}>:-Werror>)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
endfunction()

# orthant_compile_quickly(target): for code that waits for the libraries, whose optimizing costs more than it can save.
function(orthant_compile_quickly target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1>")
endfunction()
