# SPDX-License-Identifier: MIT
# Most of the time of compiling goes into headers, so the files of a module are compiled as a few sources.

# Names that SOURCE gives within anonymous namespaces, as a list in RESULT: functions, types, variables and aliases. Two
# overloads of a function count as one name.
function(fabseq_private_names source result)
  file(STRINGS ${source} lines REGEX "^(namespace {|}  // namespace)$|^[A-Za-z].*[A-Za-z0-9_] *[({=;]")
  set(names "")
  set(inside FALSE)
  foreach(line IN LISTS lines)
    if(line STREQUAL "namespace {")
      set(inside TRUE)
    elseif(line STREQUAL "}  // namespace")
      set(inside FALSE)
    elseif(inside AND NOT line MATCHES "^(template|static_assert|namespace|(TYPED_)?TEST|INSTANTIATE|REGISTER)" AND
           line MATCHES "^(class|struct|union|enum class|enum|using) ([A-Za-z0-9_]+)|([A-Za-z0-9_]+) *[({=;]")
      list(APPEND names "${CMAKE_MATCH_2}${CMAKE_MATCH_3}")
    endif()
  endforeach()
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

# Puts each of the sources below DIRECTORY into one of up to three groups of its module, which is the first folder of
# its path. A file's first choice follows from a checksum of its path, so that a new file compiles only those beside it
# once more. A group takes no two files that share a private name; a file that no group takes is compiled alone.
function(fabseq_unity_groups directory)
  foreach(source IN LISTS ARGN)
    file(RELATIVE_PATH name ${directory} ${source})
    string(REGEX MATCH "^[a-z_]+" module ${name})
    string(MD5 digest ${name})
    string(SUBSTRING ${digest} 0 4 digits)
    fabseq_private_names(${source} names)
    set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    foreach(shift RANGE 2)
      math(EXPR part "(0x${digits} + ${shift}) % 3")
      set(group ${module}_${part})
      set(shared "${names}")
      list(REMOVE_ITEM shared ${names_in_${group}} "")
      if(shared STREQUAL names)
        list(APPEND names_in_${group} ${names})
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group} SKIP_UNITY_BUILD_INCLUSION OFF)
        break()
      endif()
    endforeach()
  endforeach()
endfunction()
