# Install the build in BUILD below WORK, build the stranger's project against it, and run it on MESH.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -D CMAKE_PREFIX_PATH=${WORK}/prefix
  -D CMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/stranger ${MESH} ${WORK}/pieces)
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
