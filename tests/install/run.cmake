# Installs the build in BUILD below WORK, builds EXAMPLES against it as another project does, and runs them on MESH.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${EXAMPLES} -B ${WORK}/build -D CMAKE_PREFIX_PATH=${WORK}/prefix
  -D CMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)

# The stages one by one, which write their meshes into the current folder.
execute_process(COMMAND ${WORK}/build/own_seeds ${MESH} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status
  OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT status EQUAL 0 OR NOT output MATCHES "12 fragments\n" OR NOT EXISTS ${WORK}/0_12.ply)
  message(FATAL_ERROR "own_seeds: ${status}\n${output}")
endif()
run(${WORK}/prefix/bin/sherd inspect ${WORK}/0_12.ply)

# A dataset with its own writer: two fragments three times, three twice, four once.
file(COPY ${MESH} DESTINATION ${WORK}/library)
execute_process(COMMAND ${WORK}/build/own_dataset ${WORK}/library RESULT_VARIABLE status OUTPUT_VARIABLE csv)
string(REGEX MATCHALL "amphora.ply,[234]f_[012],[1-4],[0-9]+," lines "${csv}")
list(LENGTH lines count)
if(NOT status EQUAL 0 OR NOT count EQUAL 16)
  message(FATAL_ERROR "own_dataset: ${status}, ${count} lines of fragments\n${csv}")
endif()

run(${WORK}/build/break_a_mesh ${MESH} ${WORK}/pieces)
foreach(file manifest.json labels.rle preview.png fragments/amphora_005.vdb meshes/amphora_005.ply)
  if(NOT EXISTS ${WORK}/pieces/${file})
    message(FATAL_ERROR "${WORK}/pieces/${file} is missing")
  endif()
endforeach()
run(${WORK}/prefix/bin/sherd inspect ${WORK}/pieces)
# The copyright file has the license that the program prints.
execute_process(COMMAND ${WORK}/prefix/bin/sherd --version OUTPUT_VARIABLE version)
string(REGEX MATCH "\\((.*)\\)" ignored "${version}")
set(license ${CMAKE_MATCH_1})
file(READ ${WORK}/prefix/share/doc/sherd/copyright copyright)
string(FIND "${copyright}" "License: ${license}\n" found)
string(FIND "${copyright}" "GPL" gpl)
if(found EQUAL -1 OR (license STREQUAL "Apache-2.0" AND NOT gpl EQUAL -1))
  message(FATAL_ERROR "sherd prints the license '${license}', share/doc/sherd/copyright has:\n${copyright}")
endif()
if(NOT EXISTS ${WORK}/prefix/share/sherd/manifest.schema.json)
  message(FATAL_ERROR "the manifest's schema is not installed")
endif()
# The installed program finds the installed sherd-assimp.
file(WRITE ${WORK}/triangle.dae [[<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>]])
run(${WORK}/prefix/bin/sherd inspect ${WORK}/triangle.dae)
