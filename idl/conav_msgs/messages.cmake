# The messages, each after those that it uses, and the services.
set(conav_messages
  Cell RobotState RobotCommand RobotGoals Snapshot
  BeliefMap MessageChange Guidance CellEdit DriveOrder StopOrder OperatorRequest OperatorReply OperatorEvent
  AttentionRequest AttentionItem AttentionQueue
  RewardTerms SearchAction SearchNode SearchView SearchReport
  PerceptionQuery PerceptionRequest PerceptionAnswer PerceptionReply
  HeldRobot PlannerLease IntendedPath
  StudyMark PageArea PageLayout EyePupil EyeGaze EyeFixation EyeBlink EyeClock)
set(conav_services StepSimulation)
