# The rooms of src/, bottom to top, with their sources: docs/architecture.md says what is in each.  Few files of the library are
# compiled together, since these are slow; of the rest eight.
function(sherd_room target room)
  list(TRANSFORM ARGN PREPEND src/${room}/ OUTPUT_VARIABLE files)
  list(TRANSFORM files APPEND .cpp)
  target_sources(${target} PRIVATE ${files})
  set(size 8)
  if(target STREQUAL sherd)
    set(size 4)
  endif()
  sherd_together(${room} ${size} ${files})
endfunction()

sherd_room(sherd base memory progress)
sherd_room(sherd base/text base64 json_text library_versions natural_order option_text printable safe_name)
sherd_room(sherd base/files appended_file atomic_file below_folder direct_io parsed_json sha256 unfinished)
sherd_room(sherd cl buffer_pool builtin_device device device_search drivers instructions kernel_cache kernel_launch)
if(SHERD_OPENCL)
  sherd_room(sherd cl error_name open_cl_device open_cl_loader open_cl_parameters open_cl_program open_cl_search)
else()
  sherd_room(sherd cl no_open_cl)
endif()
sherd_room(sherd mesh
  coordinate_system hull mass_sums measure plane_moments principal_inertia self_affine_noise surface_by_area symmetric_eigen topology
  vertex_normals)
sherd_room(sherd mesh/search curtain inside mesh_distance near_boxes sided_mesh triangle_tree winding_in_ball winding_number)
sherd_room(sherd mesh/attributes bent_attributes charts colors seams)
sherd_room(sherd mesh/repair bodies_apart duplicates flat_share repair sheets split_objects)
sherd_room(sherd intersect
  crossing_point cut_mesh dyadic find_crossings half_edges homogeneous_point predicates self_crossings split_triangles
  triangle_pair triangle_plane triangulate)
sherd_room(sherd intersect/arrange arrangement plane_arrangement point_set unite winding_of_patches)
sherd_room(sherd clean carrier change clean defect guard part_sheets rounded_crossings rounded_faults star_fans stars)
sherd_room(sherd voxelize/leaves leaf_blocks leaf_masks spread voxel_owners)
sherd_room(sherd voxelize/fill caps exposed fill flood generalized_winding holes searched_mesh walls winding)
sherd_room(sherd voxelize/bodies body_layers bridges disjoint_bodies kept_bodies)
sherd_room(sherd voxelize
  band canonical_solid discs distance level_set_mesh region shell_mesh voxelize wall_middles wall_normals wall_samples)
sherd_room(sherd seed/draw candidates density distinct_middles grid_density poisson samplers sizes voxel_index wall)
sherd_room(sherd seed explicit_seeds fragment_ids impact_rings impacts leaf_densities nearest_seed ray seeds split_impacts)
sherd_room(sherd grow/fields
  apart_leaves components flood growth_rules growth_state levels metric relief rough seed_kernel settle small_components
  solid_components)
sherd_room(sherd grow/sized crack_areas least_share raise_small shares sized_growth split_plan)
sherd_room(sherd grow/splits
  given_splits guide_sides sequential split split_fracture split_impact split_nodes split_planes split_sides split_wall)
sherd_room(sherd grow grow)
sherd_room(sherd erode erode largest_part masks passes shape shell)
sherd_room(sherd remesh
  bodies boundary_loops collapse_log complex complex_faults face_edges face_ring flat_triangles manifold
  region_edges seam_charts seam_cuts smooth)
sherd_room(sherd remesh/decimate
  crack_overhang crossing_faces decimate edge_collapse facet_chains facet_polygon facets fan_crossings merge_facets
  simplified_cracks)
sherd_room(sherd remesh/resample crack_jitter resample sampled_mesh surface_samples)
sherd_room(sherd remesh/parts clean_meshes close_mesh fill_loops loose_bodies part_edges small_voids)
sherd_room(sherd cut cut label_cells level_set nearest_label site_cut split_cut)
sherd_room(sherd interface/cells
  cell cell_crossings cell_values cell_vertex contact_boundaries crease_point crease_vertices creases find_creases input_crossings
  leaf_cells quad_crossings)
sherd_room(sherd interface
  contacts cut_solid flat_input intact interface_mesh interface_surface non_manifold_vertices)
sherd_room(sherd surface/exact
  body_clusters closed_solid cluster_solids crack_surface exact_by_cluster exact_meshes exact_surface kept_meshes labels_beyond
  layer patches settled_labels sheet_middles)
sherd_room(sherd surface boundary_distance check_finite displaced_points extract fragment_surfaces label_mesh simplify surface_noise)
sherd_room(sherd points
  check_points correspondences eliminate point_sequence sample_distances sample_fragments sample_points signed_distances)
sherd_room(sherd appearance exact_transfer source_faces transfer weights)
sherd_room(sherd pipeline
  deciding fracture fracture_stages guide_surfaces materials memory_estimate presets refracture refracture_islands
  refracture_meshes withheld)
sherd_room(sherd evaluate/cracks
  coincident_vertices contact_graph contact_plane crack_faces crack_roughness fragment_shape grid_trace heights joint_gaps planar_areas
  triangle_points)
sherd_room(sherd evaluate
  assembly convexity distance_neighbors evaluate fit mesh_quality parting_splits published_figures size_fits statistics summary)
sherd_room(sherd render aovs backdrop camera embree_scene light occluders palette preview_fragment raster render scene trace)
sherd_room(sherd formats output_file)
sherd_room(sherd formats/arrays hdf5_pack npy_objects npy_reader npz zip_reader zip_writer)
if(SHERD_HDF5)
  sherd_room(sherd formats/arrays hdf5_file hdf5_library)
else()
  sherd_room(sherd formats/arrays no_hdf5)
endif()
sherd_room(sherd formats/mesh
  beside contradictions creases faces identifiers material materials merge mesh_stream normals piece_mesh polygon_mesh polylines
  scene source_contradictions triangulate)
sherd_room(sherd formats/ply ply ply_body ply_neighbors read_ply)
sherd_room(sherd formats/obj mtl obj read_obj)
sherd_room(sherd formats/gltf
  glb glb_file glb_materials glb_mesh gltf_accessor gltf_attributes gltf_document gltf_draco gltf_primitive gltf_root
  gltf_transforms read_gltf scene_glb)
sherd_room(sherd formats/usd usd usd_material usd_mesh usd_text)
sherd_room(sherd formats/geo geo geo_text)
sherd_room(sherd formats/mesh_files
  assimp_fault binm mesh_file model_3mf package_3mf read_3mf read_assimp read_binm read_lines read_mesh read_off read_stl stated_coordinates
  stl write_mesh xml_tags)
sherd_room(sherd formats/voxels
  bing encode_runs magica_voxel_read magica_voxel_write npy_labels quad_stack read_vdb read_volume rle vdb vdb_structure vdb_tree
  vdb_unit voxel_faces voxel_files voxel_lookup voxel_runs)
sherd_room(sherd formats/points octree_stream point_files range_coder read_points)
sherd_room(sherd formats/images exr png)

# Folders and datasets: nothing of it is slow.
sherd_room(sherd_folders chart charts evaluation_plot statistics_plot svg)
sherd_room(sherd_folders options coordinates draw growth_rows output_rows parsed preset_draws recenter record rules solid_rows table)
sherd_room(sherd_folders viewer encode page simplify)
sherd_room(sherd_folders folder/manifest
  again file_names fracture_folder input_bodies listed_files manifest mesh_report own_files partial_folder read_manifest rounding
  small_pieces)
sherd_room(sherd_folders folder/files
  boundaries constraints copied_files fracture_files graph mesh_writer proxy split_levels viewer_file write_memory write_points)
sherd_room(sherd_folders folder/read
  file_kind finished_fracture fragment_meshes read_density read_fracture read_fragments read_pieces recorded_neighbors seed_file view_folder
  voxels_of_meshes)
sherd_room(sherd_folders folder write_fracture)
sherd_room(sherd_folders dataset/store archive byte_blocks file_queue held_bytes store)
sherd_room(sherd_folders dataset/journal failure journal json_fields object_folder own_sums plan)
sherd_room(sherd_folders dataset/layouts
  bb_lists fracture_line hdf5_join hdf5_lists hdf5_part hdf5_record hdf5_verify identity layout parsed_journal pfpp pfpp_matches
  split_of)
sherd_room(sherd_folders dataset/report report resources run_record statistics thumbnails)
sherd_room(sherd_folders dataset/recipe licenses recipe)
sherd_room(sherd_folders dataset/assemblage compose compose_grid draw parts)
sherd_room(sherd_folders dataset
  assemblage_run distinct forecast fracture_output growth_ahead index library object_limits object_run options output_root replaced_files replacement run_dataset schedule
  stored_object verify)

# The program.
sherd_room(sherd_cli cli/terminal
  foreign_exit held_files interrupts output_path overall_progress progress_events progress_line uncaught worker_threads)
sherd_room(sherd_cli cli/arguments
  command_line config_arguments config_file machine_options nearest_name option_text table_options)
sherd_room(sherd_cli cli/evaluate evaluate_csv evaluate_json evaluate_table statistics_json statistics_table)
sherd_room(sherd_cli cli/doctor doctor_command doctor_device doctor_host)
sherd_room(sherd_cli cli
  convert_command dataset_command dataset_printer devices_command evaluate_command fracture_command fracture_printer
  inspect_command main options_command render_command view_command)
