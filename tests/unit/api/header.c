/* evo/evo.h in C: it compiles with warnings as errors, and its structs have the sizes that
 * programs built with it count on. */
#include "evo/evo.h"

const size_t sizes_in_c[] = {
    sizeof(evo_task_facts), sizeof(evo_robot_facts), sizeof(evo_arrays),
    sizeof(evo_start),      sizeof(evo_object),      sizeof(evo_sim_arrays),
    sizeof(evo_sim_object), sizeof(evo_curve_point), sizeof(evo_policy_facts),
    sizeof(evo_training),   sizeof(evo_view),        sizeof(evo_learner_facts),
    sizeof(evo_voxels),     sizeof(evo_episode),     sizeof(evo_sim_gradients),
};
const size_t sizes_in_c_count = sizeof sizes_in_c / sizeof sizes_in_c[0];
