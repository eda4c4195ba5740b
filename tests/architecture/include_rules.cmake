# cmake -DSOURCE_DIR=... -P include_rules.cmake
# The dependencies between modules, checked in the includes: meshes <- fast, meshes <- reference, all <- compare.

set(forbidden_meshes    "fast/|reference/|compare/|deal.II/|vtk|mpi|fcl/|ceres/|cholmod|CLI/")
set(forbidden_fast      "reference/|compare/|deal.II/|vtk|mpi|ceres/|cholmod|toml")
set(forbidden_reference "fast/|compare/|vtk|fcl/|ceres/|toml|CLI/")
set(forbidden_compare   "deal.II/|fcl/|cholmod|mpi|toml")
set(wrong "")

foreach(folder meshes fast reference compare)
  file(GLOB_RECURSE files "${SOURCE_DIR}/${folder}/*.h" "${SOURCE_DIR}/${folder}/*.cc")
  if(NOT files)
    list(APPEND wrong "${folder}/: no source found, so nothing was checked")
  endif()
  foreach(file ${files})
    file(STRINGS "${file}" includes REGEX "^[ \t]*#[ \t]*include")
    foreach(line ${includes})
      # Two files may include TOML: the reader of scenes, and its common part with studies and gates. One may include
      # FCL, which allocates and is never used in a tick. One may include MPI.
      if(line MATCHES "[<\"](${forbidden_${folder}})" OR
         (folder STREQUAL meshes AND line MATCHES "[<\"]toml" AND NOT file MATCHES "/(scene_io\\.cc|toml_reader\\.h)$") OR
         (folder STREQUAL reference AND line MATCHES "[<\"]mpi" AND NOT file MATCHES "/ranks\\.cc$") OR
         (folder STREQUAL fast AND line MATCHES "[<\"]fcl/" AND NOT file MATCHES "/separation\\.cc$"))
        list(APPEND wrong "${file}: ${line}")
      endif()
    endforeach()
  endforeach()
endforeach()

# No other folders at the top level.
file(GLOB entries RELATIVE "${SOURCE_DIR}" "${SOURCE_DIR}/*" "${SOURCE_DIR}/.*")
foreach(entry ${entries})
  if(IS_DIRECTORY "${SOURCE_DIR}/${entry}" AND
     NOT entry MATCHES "^(\\.|\\.\\.|\\.git|\\.ci|meshes|fast|reference|compare|tests|reports|build|out)$")
    list(APPEND wrong "${entry}/: not a folder of the design")
  endif()
endforeach()

if(wrong)
  list(JOIN wrong "\n  " text)
  message(FATAL_ERROR "Broken dependency rules:\n  ${text}")
endif()
