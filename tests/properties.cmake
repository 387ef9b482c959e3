# Fixtures and costs of single tests. gtest_discover_tests gives all tests of a program the same
# properties, so ctest reads this file after the programs' lists of tests.

# rths_tests(<program> <regular expression> <property> <value>): an expression that matches no test is an error.
function(rths_tests program expression property value)
  set(tests "${${program}_TESTS}")
  list(FILTER tests INCLUDE REGEX "${expression}")
  if(${program}_TESTS AND NOT tests AND NOT RTHS_SANITIZER STREQUAL "thread")
    message(FATAL_ERROR "tests/properties.cmake: ${program} has no test '${expression}'")
  endif()
  if(property STREQUAL TIMEOUT)
    math(EXPR value "${value} * ${RTHS_SLOWNESS}")
  endif()
  foreach(test IN LISTS tests)
    set_tests_properties("${test}" PROPERTIES ${property} "${value}")
  endforeach()
endfunction()

# rths_long(<program> <label> <regular expression>): tests that `./lab test` runs only with --full. They have the label
# long, `ctest -LE long` omits them, and ten minutes each: the host may be busy with the sanitizers' builds.
function(rths_long program label expression)
  rths_tests(${program} "${expression}" LABELS "${label};long")
  rths_tests(${program} "${expression}" TIMEOUT 600)
endfunction()

# Diagnoses of whole runs. The default run has those of the main example.
rths_long(rths_diagnosed_run_test system "^(VerticalCoupling|RunDiagnosis\\.(Compares|NamesNoSensor)|DetunedTracking\\.Raises)")
rths_long(rths_diagnosed_run_test system "^DiagnosedRun\\.(GivesTheSameBytes|IsDiagnosedAgain)")
rths_long(rths_command_test system "^(CaseOfARun\\.IsExplained|FirstContact\\.ShowsTheStepsOfADiagnosis)")
rths_long(rths_command_test system "^Rates/Rate\\..*/10")
# Diagnoses of one effect each. The default run has some of each family, and the blind cases.
rths_long(rths_diagnosis_examples_test physics "/(synthetic/structure|synthetic/masses|actuator/)")
rths_long(rths_dynamic_diagnosis_test physics "MassesOnSprings.*/(saturation|play|friction|softening|delay)")
rths_long(rths_dynamic_diagnosis_test physics "LinearSystems.*/(dead_zone|friction|lost_signs|softening)|FreeForm.*Stiffening")
rths_long(rths_dynamic_diagnosis_test physics "Predictions.*/(delay|lost_signs|play)")
rths_long(rths_improved_case_test physics "OfAStructure|OfABearing|OfMasses|OfALinearSystem|^Plan\\.StatesTheSize")
rths_long(rths_invariance_test physics "UnitOfLength|AFormIsDescribed|HalfTheSamplingRate|OneRecordMore")
rths_long(rths_rule_test physics "^Rule\\.(OfUnloading|WithSlip)|^TwoAxes\\.HaveDrag")
rths_long(rths_next_test_test physics "^NextTest\\.Separates|LateActuator.*lag|^Intervals")
rths_long(rths_real_data_test physics "\\.(Silverbox|MrDamper|FrictionDevice|EmpsHasMoreFriction)|^LongCorpus")
# LeadRubberX with one effect at a time: another row has all of them.
rths_long(rths_opensees_test physics "/LeadRubberX(Cavitation|BucklingLoad|Horizontal|Vertical|FourEffects|Heating|Against)")
rths_long(rths_session_test system "^PairOfRuns\\.Has(ItsHidden|NoFalse)")
# Others that take long.
rths_long(rths_judgement_test unit "Smallest\\.FaultThatIsFound")
rths_long(rths_commissioning_command_test system "^Machines/PretestOfExample")
# Minutes on an idle host.
rths_long(rths_monitor_test system "^Cost\\.")
rths_long(rths_bench_command_test system "^SrmdBench\\.DoesNotRepeat")

# All tests of the cards: ctest -L scramnet
foreach(program rths_replicated_test rths_scramnet_card_test)
  rths_tests(${program} "." LABELS "unit;scramnet")
endforeach()
foreach(program rths_scramnet_test rths_ring_command_test rths_replicated_card_test rths_replicated_clients_test)
  rths_tests(${program} "." LABELS "system;scramnet")
endforeach()

# Tests that read the shared run.
rths_tests(rths_page_test "^Page\\." FIXTURES_REQUIRED shared_run)
rths_tests(rths_diagnosed_run_test "^DiagnosedRun\\." FIXTURES_REQUIRED shared_run)

# They remove the rings of dead processes, which other tests make on purpose.
rths_tests(rths_left_ring_test "." RUN_SERIAL ON)
rths_tests(rths_command_test "^(DoctorAndClean|CleanCommand)\\." RUN_SERIAL ON)

# In real time, as those with the label realtime.
rths_tests(rths_contradictions_test "InRealTime" LABELS realtime)

# In real time with a limit of time of their own: they run alone. The other ones wait more than they compute, so
# `./lab test` runs several of them at once.
rths_tests(rths_wall_run_test "^(Of/Death|OpenSeesWall\\.RunsInRealTime|WallRun\\.(TakesAsLong|EndsWhen|ComesToRestWhen|IsNotCompleted))" RUN_SERIAL ON)
rths_tests(rths_death_trial_test "." RUN_SERIAL ON)
rths_tests(rths_foreign_node_test "StopsTheRunWithinTwoSeconds" RUN_SERIAL ON)
rths_tests(rths_live_test "^Live\\." RUN_SERIAL ON)

# With RTHS_LONG=1, forty runs each.
rths_tests(rths_death_trial_test "." TIMEOUT 1200)

# Tests with the highest cost start first [s].
rths_tests(rths_diagnosed_run_test "^(VerticalCoupling|DetunedTracking)\\." COST 18)
rths_tests(rths_diagnosed_run_test "^DiagnosedRun\\." COST 8)
rths_tests(rths_diagnosed_run_test "^RunDiagnosis\\.Compares" COST 30)
rths_tests(rths_real_data_test "\\.(SilverboxHas|MrDamperHas)" COST 20)
rths_tests(rths_real_data_test "\\.(SilverboxWithout|MrDamperWithout|FrictionDeviceHas)" COST 10)
rths_tests(rths_next_test_test "^Intervals\\." COST 15)
rths_tests(rths_rule_test "." COST 10)
rths_tests(rths_diagnosis_test "^Diagnosis\\." COST 6)
rths_tests(rths_dynamic_diagnosis_test "." COST 5)
rths_tests(rths_opensees_test "." COST 3)
rths_tests(rths_plant_test "^(Basis|Energy|ExportFromOpenSees|LiftOff|ReducedPlant)\\." COST 6)
rths_tests(rths_replicated_test "On256Nodes" COST 4)

# Long with RTHS_LONG=1, and longer on a loaded host.
rths_tests(rths_real_data_test "^RealData\\." TIMEOUT 900)
rths_tests(rths_dds_test "^Gateways\\.LoseNothing" TIMEOUT 900)
rths_tests(rths_bridge_test "^TwoHosts\\.Converge|^VendorHosts|^GarbledNetwork" TIMEOUT 1800)
rths_tests(rths_several_hosts_test "InVirtualTime" TIMEOUT 900)
rths_tests(rths_diagnosed_run_test "." TIMEOUT 700)

# Thousands of deaths with RTHS_LONG=1, several times slower under sanitizers.
rths_tests(rths_broker_test "KillsOf" TIMEOUT 900)
rths_tests(rths_damaged_ring_test "CrashesNo" TIMEOUT 3600)
rths_tests(rths_recording_test "WithDamage" TIMEOUT 900)
rths_tests(rths_command_test "DamagedRingCommands" TIMEOUT 900)

# With RTHS_LONG=1, ten thousand steps, and a run of 40 s.
rths_tests(rths_replicated_clients_test "Handshake" TIMEOUT 700)
rths_tests(rths_command_test "OnARingOfCards" TIMEOUT 600)

# With RTHS_LONG=1, complete runs of the examples.
rths_tests(rths_commissioning_command_test "^Machines/PretestOfExample\\." TIMEOUT 1200)

# With RTHS_LONG=1, a million writes on 256 nodes.
rths_tests(rths_replicated_test "On256Nodes" TIMEOUT 1200)

# With RTHS_LONG=1, a million sequences of commands.
rths_tests(rths_safety_test "NoCommandMoves" TIMEOUT 3600)
