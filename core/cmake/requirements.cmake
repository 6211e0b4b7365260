# orthant_require(WHAT FOUND PACKAGES…), then orthant_check_requirements(): one message for all that is missing,
# with the names of their packages: Debian (and Ubuntu), Fedora, Homebrew, conda-forge, in this order.
set(orthant_missing "" CACHE INTERNAL "")

function(orthant_require what found debian fedora homebrew conda)
  if(NOT found)
    set(orthant_missing "${orthant_missing};${what}|${debian}|${fedora}|${homebrew}|${conda}" CACHE INTERNAL "")
  endif()
endfunction()

function(orthant_check_requirements)
  set(text "")
  foreach(system RANGE 1 4)
    set(packages_${system} "")
  endforeach()
  foreach(one IN LISTS orthant_missing)
    string(REPLACE "|" ";" parts "${one}")
    list(LENGTH parts length)
    if(length LESS 5)
      continue()
    endif()
    list(GET parts 0 what)
    string(APPEND text "  ${what}\n")
    foreach(system RANGE 1 4)
      list(GET parts ${system} package)
      string(APPEND packages_${system} " ${package}")
    endforeach()
  endforeach()
  set(orthant_missing "" CACHE INTERNAL "")
  if(text)
    message(FATAL_ERROR "Orthant needs, but did not find:\n${text}Install them by one of:\n"
      "  Debian, Ubuntu:  apt-get install${packages_1}\n"
      "  Fedora:          dnf install${packages_2}\n"
      "  Homebrew:        brew install${packages_3}\n"
      "  conda-forge:     conda install -c conda-forge${packages_4}\n")
  endif()
endfunction()
