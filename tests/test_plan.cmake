# SPDX-License-Identifier: MIT
# On how many ranks a test runs, what it costs and which labels it has. CONTRIBUTING.md says what to run when.

# Tests that register a stage, a kind of sequence or a finding, which all others of the same program would see.
set(FABSEQ_REGISTERING stage_mpi_test sequence_kind_mpi_test finding_mpi_test)

# Rank counts of NAME_mpi_test of a module. On four ranks, a rank has neighbours along two axes and may be
# left without work; elsewhere two ranks reach all code. Sanitizers look for paths: one count, a single rank
# where cases need it that take long, and both where they do not.
set(FABSEQ_ENGINE kernels ranks multigrid islands cg)
set(FABSEQ_DECOMPOSED parallel grid part files ${FABSEQ_ENGINE} machine solve sequence thermal)
set(FABSEQ_THREE_TOO island_map_mpi_test part_mpi_test step_transpose_mpi_test)  # the middle of three ranks has a neighbour on either side
set(FABSEQ_ALONE lane_cg_mpi_test lane_cg_lanes_mpi_test)
set(FABSEQ_ALONE_TOO stop_mpi_test)
function(fabseq_rank_counts result name module)
  set(counts 1)
  if(name MATCHES "_mpi_test$")
    if(FABSEQ_SANITIZE)
      set(counts 2)
      if(module IN_LIST FABSEQ_DECOMPOSED)
        set(counts 3)  # one of them without work, as tests/support/share.h deals it out
      endif()
      if(name IN_LIST FABSEQ_ALONE)
        set(counts 1)
      elseif(name IN_LIST FABSEQ_ALONE_TOO)
        list(PREPEND counts 1)
      endif()
    else()
      set(counts 1 2)
      if(module IN_LIST FABSEQ_DECOMPOSED)
        list(APPEND counts 4)
      endif()
      if(name IN_LIST FABSEQ_THREE_TOO)
        list(APPEND counts 3)
      endif()
    endif()
  endif()
  set(${result} ${counts} PARENT_SCOPE)
endfunction()

# Topics of tests/integration that sanitizers leave out: of scripts, which run the program as the other topics
# do; of digits, which the release build looks at; and of classes whose own tests sanitizers run.
set(FABSEQ_RELEASE_TOPICS "benchmarks|calculix|calibrate|calibrate_checks|calibrate_flow|calibrate_runs|compensate|gradient_matrix|one_reader|orient|own_kinds|package|plan|slurm|slurm_studies")
string(APPEND FABSEQ_RELEASE_TOPICS "|python|python_errors|deposition|direct|groups|lost_disk|pictures|ranks|readme|scenarios|squares|stop")
string(APPEND FABSEQ_RELEASE_TOPICS "|coarse|gradients|welded_back|install|model_group|multi_planar|region|reruns|sensitivity|starts|verdict")

# Seconds on 2 cores of what takes longer than others: ctest starts it first, so that no core waits for it at
# the end.
set(FABSEQ_COSTS
    integration.readme=170 integration.stop=110 faults.sample=120 integration.restart=75 integration.restart_checkpoints=35 integration.slurm=100
    integration.slurm_studies=60 integration.lost_disk=30 scripts.report_test=35 scripts.report_browser_test=45 evidence.reproduce=70 integration.configs=70 integration.multi_planar=65
    integration.sensitivity=65 integration.benchmarks=65 integration.config_errors=25 integration.part_errors=15 integration.command_line=20 integration.ranks=60
    scripts.overview_test=50 scripts.launch_test=50 integration.scenarios=50 integration.groups=50 integration.direct=50 integration.thermal=45 integration.verdict=40
    layer_groups_mpi_test.np4=50 scripts.export_paths_test=45 integration.deposition=45 integration.failures=40
    integration.orient=40 integration.compensate=40 integration.calibrate=40 integration.calibrate_runs=25 integration.calibrate_checks=25 integration.calibrate_flow=60 integration.gradient_matrix=40 integration.guided=30 integration.welded_back=100
    lane_elasticity_mpi_test.np4=20 lane_elasticity_batches_mpi_test.np4=15 heat_sequence_mpi_test.np4=30 integration.locale=30 integration.locks=30
    integration.mesh=30 integration.simulate=20 integration.coarse=20 integration.starts=15 integration.squares=20 integration.leaks=20
    integration.one_reader=10 integration.judged_again=20 integration.beads=20 integration.pictures=20 integration.model_group=20 integration.check_picture=20 scripts.compare_test=20 faults.configs=15 integration.hostile_input=15
    integration.reference=15 integration.gradients=15 integration.calculix=15 integration.install=15 integration.python=10 integration.python_errors=5 integration.own_kinds=20 integration.package=5 integration.plan=40
    scripts.tools_package_test=15 scripts.new_config_test=25 scripts.new_config_pieces_test=20 scripts.new_config_beads_test=20 scripts.study_tools_test=45 scripts.machine_option_test=30 integration.machine_file=10 scripts.answer_test=20 scripts.damaged_files_test=15 scripts.virtual_display_test=15 integration.outputs=10 run_lock_test.np1=12)
function(fabseq_cost result name)
  set(cost 1)
  foreach(entry ${FABSEQ_COSTS})
    if(entry MATCHES "^([^=]+)=([0-9]+)$" AND CMAKE_MATCH_1 STREQUAL name)
      set(cost ${CMAKE_MATCH_2})
    endif()
  endforeach()
  set(${result} ${cost} PARENT_SCOPE)
endfunction()

# What to run after which kind of change: LABEL=REGEX of MODULE/NAME.
set(FABSEQ_LABELS
    "kernels=^(kernels|ranks|multigrid|islands|cg|fem)/"
    "gradients=^(responses|layers|process|sequence|chain|optimize)/|^integration/integration.(gradient|guided|reference|squares|direct|deposition|sensitivity)"
    "files=^(files|faults|config|keys)/|^integration/integration.(command_line|config_errors|part_errors|hostile_input|lost_disk|machine_file|mesh|model_group|outputs|reruns|restart|stop|failures|simulate|locale|locks)"
    "scripts=^scripts/|^integration/integration.(benchmarks|calculix|calibrate|compensate|orient|pictures|plan|readme|slurm|install|package)"
    "evidence=^evidence/"
    "indices=^(base/mpi|grid|part|solve|files|sequence)"
    "slurm=^integration/integration.slurm"
    "quick=^(base|keys|parallel|grid|mesh|part|files|fem|solve|sequence|layers|machine|process|responses|config|mma|model|chain|optimize|report|repair)/|^scripts/")
# What scripts/test.sh --all has beside the tests that each change must pass: commands of the pages, campaigns, packages,
# studies and pictures, Slurm, and four ranks where two have the same code.
set(FABSEQ_THOROUGH "^integration/integration.(calibrate.*|check_picture|compensate|configs|install|leaks|lost_disk|multi_planar|orient|own_kinds|package|pictures|plan|python|python_errors|readme|sensitivity|slurm|slurm_studies|stop|welded_back)$")
string(APPEND FABSEQ_THOROUGH "|^faults/faults.sample$|^evidence/|^benchmarks/")
string(APPEND FABSEQ_THOROUGH "|^scripts/scripts.(answer|compare|damaged_files|export_.*|launch|machine_option|new_config_pieces|overview|plots|report|report_browser|study_tools|tools_package|virtual_display)_test$")
function(fabseq_labels result module name)
  set(labels)
  if("${module}/${name}" MATCHES "${FABSEQ_THOROUGH}" OR (name MATCHES "\\.np4$" AND NOT module STREQUAL "parallel"))
    list(APPEND labels thorough)
  endif()
  foreach(entry ${FABSEQ_LABELS})
    string(REGEX MATCH "^([a-z]+)=(.*)$" _ "${entry}")
    set(label ${CMAKE_MATCH_1})
    if("${module}/${name}" MATCHES "${CMAKE_MATCH_2}")
      list(APPEND labels ${label})
    endif()
  endforeach()
  if(name MATCHES "_mpi_test\\.np[14]$")
    list(REMOVE_ITEM labels quick)  # two ranks, or what sanitizers have, will do
  endif()
  set(${result} "${labels}" PARENT_SCOPE)
endfunction()
