# anthesis_embed_species(<target>)
#
# Makes the files of species/ part of <target>, as builtin_species() of anthesis/exchange/species_file.h.
# With -P it is the script that writes the source: -D OUTPUT=<file.cpp> -D INPUTS=<a.toml|b.toml>.
if(CMAKE_SCRIPT_MODE_FILE)
  string(REPLACE "|" ";" inputs "${INPUTS}")
  set(entries "")
  set(arrays "")
  foreach(input IN LISTS inputs)
    get_filename_component(name ${input} NAME_WE)
    file(READ ${input} hex HEX)
    string(LENGTH "${hex}" size)
    math(EXPR size "${size} / 2")
    string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
    list(LENGTH array_names index)
    list(APPEND array_names ${name})
    string(APPEND arrays "constexpr char kFile${index}[] = {\n${bytes}'\\0'};\n")
    string(APPEND entries "    {\"${name}\", std::string_view(kFile${index}, ${size})},\n")
  endforeach()
  list(LENGTH inputs count)
  file(WRITE ${OUTPUT} "// Made from species/*.toml while building.
#include \"anthesis/exchange/species_file.h\"

namespace anthesis {
namespace {
${arrays}
constexpr BuiltinSpecies kBuiltin[] = {
${entries}};
}  // namespace

std::span<const BuiltinSpecies> builtin_species() { return kBuiltin; }

}  // namespace anthesis
")
  return()
endif()

set(ANTHESIS_EMBED_SPECIES_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(anthesis_embed_species target)
  file(GLOB inputs CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/species/*.toml)
  list(SORT inputs)  # by name, as the header promises
  set(output ${CMAKE_CURRENT_BINARY_DIR}/builtin_species.cpp)
  string(REPLACE ";" "|" joined "${inputs}")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -D OUTPUT=${output} -D "INPUTS=${joined}" -P ${ANTHESIS_EMBED_SPECIES_SCRIPT}
    DEPENDS ${inputs} ${ANTHESIS_EMBED_SPECIES_SCRIPT}
    COMMENT "Embedding the built-in species" VERBATIM)
  target_sources(${target} PRIVATE ${output})
endfunction()
