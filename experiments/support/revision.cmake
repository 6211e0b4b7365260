# Writes orthant_build.h with the revision as it is at build time; an unchanged file is left alone, so nothing recompiles.
execute_process(COMMAND git -C "${SOURCE}" describe --always --abbrev=12 --match= --dirty=+changes
                OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(revision "unknown")
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[
#pragma once
#define ORTHANT_VERSION "@VERSION@"
#define ORTHANT_REVISION "@revision@"
#define ORTHANT_COMPILER "@COMPILER@"
#define ORTHANT_FLAGS "@FLAGS@"
]] @ONLY)
