/* The library of evo for C, C++ and any language that can call C.
 *
 *   evo_task* task;
 *   evo_robots* robots;
 *   evo_envs* envs;
 *   evo_arrays at;
 *   if (evo_task_open("Walker-v0", &task) || evo_robots_read("walker.json", &robots) ||
 *       evo_envs_open(task, robots, 16, 1, &envs) || evo_envs_arrays(envs, &at, sizeof at) ||
 *       evo_envs_reset(envs, NULL, 0, NULL) ||
 *       evo_envs_step(envs, actions, at.action_values, NULL, 0))
 *     puts(evo_error());
 *   printf("%g\n", at.rewards[0]);
 *
 * Every function that can fail returns EVO_OK or what kind of failure it was; evo_error()
 * then says in one line what went wrong, where, and what to do. A call that failed has
 * changed nothing. Handles are opaque; one that is NULL, was freed, or is of another kind
 * is refused with EVO_USAGE, as is NULL where something is to be written. Freeing NULL does
 * nothing. Handles keep nothing of the arguments they were made from: those may be freed.
 *
 * Different handles may be used by different threads at once. A second thread in a function
 * that changes a handle (a step, a reset) is refused with EVO_USAGE. After fork() a child may
 * use handles made with one thread; those with more have lost theirs: there they are refused with
 * EVO_USAGE, and the child makes its own.
 *
 * The same seeds give the same bits as the tools do, for any number of threads and on any
 * processor. Arrays are double, row by row; positions are [points][2], x and y (upwards), in
 * the benchmark's raw units: a voxel is 0.1 wide, a control step takes 0.003 of the time in
 * velocities.
 */
#ifndef EVO_EVO_H
#define EVO_EVO_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define EVO_API __attribute__((visibility("default")))
#else
#define EVO_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The values are the exit statuses of the tools. */
enum {
  EVO_OK = 0,
  EVO_WORK = 1,           /* the work itself failed */
  EVO_USAGE = 2,          /* an argument makes no sense, or names what does not exist */
  EVO_DATA = 65,          /* a file or document makes no sense */
  EVO_NO_INPUT = 66,      /* a file is missing */
  EVO_CANNOT_CREATE = 73, /* a file cannot be created */
  EVO_IO = 74             /* reading or writing failed halfway */
};

EVO_API const char* evo_version(void); /* of the library in use: "0.1.0" */
/* The last failure in this thread, until its next one; "" before the first. */
EVO_API const char* evo_error(void);
/* What the library gave away: texts and bytes. */
EVO_API void evo_free(void* given);

/* ---- tasks ---------------------------------------------------------------------------- */

/* A world, what is observed in it and rewarded, and when an episode ends. */
typedef struct evo_task evo_task;

/* A benchmark task by name, or a YAML file. Names are looked for in the folders of $EVO_TASKS,
 * then in $EVO_DATA, else where the library was installed. */
EVO_API int evo_task_open(const char* name_or_file, evo_task** task);
EVO_API void evo_task_free(evo_task* task);

/* As --physics of the tools: a profile by name or file ("paper"), constants ("gravity=50"), in
 * any order, checked together. What is refused (EVO_USAGE, EVO_DATA, EVO_NO_INPUT) changes
 * nothing. */
EVO_API int evo_task_set_physics(evo_task* task, const char* const* words, size_t count);

typedef struct evo_task_facts {
  const char* name; /* these two as long as the task is not changed or freed */
  const char* yaml;
  int32_t episode_steps; /* time limit, steps */
  int32_t hold;          /* control steps of a step */
  /* The range of actions: an actuator's target length as a share of its rest length. */
  double action_low;
  double action_high;
  const char* physics_yaml; /* the whole profile in force; as long as `yaml` */
} evo_task_facts;
/* `size` is that of the caller's struct: later versions may know more. So in what follows. */
EVO_API int evo_task_describe(const evo_task* task, evo_task_facts* facts, size_t size);

/* ---- robots --------------------------------------------------------------------------- */

/* A list of robots: bodies of voxels, and what is known of them. */
typedef struct evo_robots evo_robots;

/* All robots of a file or a text: JSON, JSON Lines, YAML, letters or numbers; a policy or
 * rollout file stands for its robot. */
EVO_API int evo_robots_read(const char* file, evo_robots** robots);
EVO_API int evo_robots_parse(const char* text, evo_robots** robots);
EVO_API int evo_robots_new(evo_robots** robots); /* an empty list */
EVO_API void evo_robots_free(evo_robots* robots);
/* Appends robot `index` of another list. */
EVO_API int evo_robots_append(evo_robots* robots, const evo_robots* others, size_t index);
EVO_API int evo_robots_count(const evo_robots* robots, size_t* count);

typedef struct evo_robot_facts {
  const char* id;   /* follows from the body alone; the pointers last until the list changes */
  const char* json; /* the whole document, one line without its newline */
  int32_t rows;
  int32_t columns;
  const uint8_t* voxels; /* [rows][columns], from the top: evo_voxel */
} evo_robot_facts;
EVO_API int evo_robots_describe(const evo_robots* robots, size_t index, evo_robot_facts* facts,
                                size_t size);

/* The benchmark's numbers. Fixed cells are terrain. */
enum evo_voxel {
  EVO_EMPTY = 0,
  EVO_RIGID = 1,
  EVO_SOFT = 2,
  EVO_HORIZONTAL = 3, /* actuators, by the direction in which they stretch */
  EVO_VERTICAL = 4,
  EVO_FIXED = 5
};

/* ---- environments of tasks ------------------------------------------------------------ */

/* Environments, stepped side by side in the processor's vector lanes. What has ended shows it,
 * and may be stepped on until it is reset. */
typedef struct evo_envs evo_envs;

/* `per_robot` environments for each robot, one robot after the other; robots may differ in
 * size. `threads` share the work of a step. */
EVO_API int evo_envs_open(const evo_task* task, const evo_robots* robots, int32_t per_robot,
                          int32_t threads, evo_envs** envs);
EVO_API void evo_envs_free(evo_envs* envs);

enum evo_env_status {
  EVO_ENV_OK = 0,
  EVO_ENV_UNRESET = 1, /* before its first reset; a step of it is an error */
  EVO_ENV_UNSTABLE = 2 /* the simulation failed; left out of steps until its next reset */
};

/* Where the values are: reset, step, restore and translate write them in place, until
 * the environments are freed. Those of environment e begin at its offset and end at the next. */
typedef struct evo_arrays {
  size_t environments;               /* E */
  size_t observation_values;         /* of all environments */
  size_t action_values;              /* */
  size_t points;                     /* */
  const size_t* observation_offsets; /* [E + 1] */
  const size_t* action_offsets;      /* [E + 1] */
  const size_t* point_offsets;       /* [E + 1] */
  const double* observations;        /* [observation_values], zeros before the first reset */
  const double* rewards;             /* [E] of the last step */
  const uint8_t* terminated;         /* [E] ended by a rule of the task */
  const uint8_t* truncated;          /* [E] ended by the time limit */
  const uint8_t* status;             /* [E] evo_env_status */
  const int32_t* steps;              /* [E] taken in this episode */
  const double* positions;           /* [points][2] all point masses of the worlds */
  const double* velocities;          /* [points][2] */
} evo_arrays;
EVO_API int evo_envs_arrays(const evo_envs* envs, evo_arrays* arrays, size_t size);

/* How episodes begin. */
typedef struct evo_start {
  int32_t has_seed; /* a seed stays in force until another is given; 0 at first */
  int32_t has_episode;
  uint64_t seed;
  /* Number within the seed: what a task draws follows from both, as in the tools. By itself
   * environment i of N of a robot plays the episodes i, i + N, i + 2 N, .. of its seed, one at each
   * reset; a seed begins this count anew. */
  uint64_t episode;
  double jitter;     /* every start coordinate is moved by up to this, voxels */
  const char* draws; /* what the task would draw, as JSON; NULL: drawn */
} evo_start;

/* Begins episodes in these environments, or in all (NULL). `start` may be NULL. */
EVO_API int evo_envs_reset(evo_envs* envs, const int32_t* environments, size_t count,
                           const evo_start* start);
/* One step: a control step, or as many of the same action as the task's `hold` says. `actions`:
 * [action_values], clipped to the task's range. `active`: [E], not 0 for those that take part, or
 * NULL for all; the others stay as they are. Refused, with nothing stepped: wrong lengths, actions
 * that are not finite, environments never reset. */
EVO_API int evo_envs_step(evo_envs* envs, const double* actions, size_t values,
                          const uint8_t* active, size_t active_values);

/* The state of an episode in progress: it continues from there as often as it is restored, in any
 * environment of the same robot, task and version, to the same bits. The bytes are opaque, and
 * for evo_free. */
EVO_API int evo_envs_save(const evo_envs* envs, int32_t environment, void** bytes, size_t* count);
EVO_API int evo_envs_restore(evo_envs* envs, int32_t environment, const void* bytes, size_t count);
/* Moves an object that is no terrain, as it is, in raw units; velocities stay, and no reward counts
 * the move. Objects as of evo_envs_object. */
EVO_API int evo_envs_translate(evo_envs* envs, int32_t environment, size_t object, double x,
                               double y);

/* Which points of an environment's world are an object's. The robot's is named "robot". */
typedef struct evo_object {
  const char* name;   /* as long as the environments are not reset or freed */
  size_t first_point; /* of the environment */
  size_t points;
} evo_object;
EVO_API int evo_envs_object_count(const evo_envs* envs, int32_t environment, size_t* count);
EVO_API int evo_envs_object(const evo_envs* envs, int32_t environment, size_t index,
                            evo_object* object, size_t size);
/* How far an object is turned from where its episode began, counter-clockwise, radians, as the
 * benchmark measures it: [count], in `positions` [count][points of the environment][2], or in the
 * present ones (NULL; count is 1). */
EVO_API int evo_envs_orientation(const evo_envs* envs, int32_t environment, size_t object,
                                 const double* positions, double* angles, size_t count);
/* The slices of an environment's observation, as JSON: [{"name", "offset", "length"}]; evo_free. */
EVO_API int evo_envs_observed(const evo_envs* envs, int32_t environment, char** json);

/* What the voxels of a robot see of themselves and of the task, for controllers whose network
 * belongs to a voxel and fits any body (docs/modular.md says which numbers). Voxels are in scan
 * order, row by row from the top. L, T and F are the same for all robots of a task. */
typedef struct evo_voxels {
  size_t voxels;            /* V */
  size_t actions;           /* A */
  size_t links;             /* N */
  size_t local_length;      /* L, of what changes with every step and voxel */
  size_t task_length;       /* T, of what changes with every step, the same for all voxels */
  size_t fixed_length;      /* F, of what never changes */
  const float* fixed;       /* [V][F]; pointers last as long as the environments */
  const int32_t* actuators; /* [A] the voxel of each action */
  const int32_t* linked;    /* [N][2] a voxel and one that it is linked to; each link both ways */
} evo_voxels;
EVO_API int evo_envs_voxels(evo_envs* envs, int32_t environment, evo_voxels* voxels, size_t size);
/* As all environments are now: `local` [V][L] of each in turn, `local_values` in all; `task`
 * [E][T]. */
EVO_API int evo_envs_look(evo_envs* envs, double* local, size_t local_values, double* task,
                          size_t task_values);

/* What a picture may leave out. */
enum evo_hide {
  EVO_HIDE_GRID = 1,       /* and distances along the floor */
  EVO_HIDE_BACKGROUND = 2, /* white instead */
  EVO_HIDE_EDGES = 4,      /* outlines of objects, seams between voxels */
  EVO_HIDE_VOXELS = 8
};

/* What a picture shows; all zeros, or NULL in its place: what moves, at 600 x 300 pixels. */
typedef struct evo_view {
  int32_t width;    /* pixels, 16 to 4096 */
  int32_t height;   /* */
  int32_t hide;     /* of evo_hide, added up */
  int32_t reserved; /* 0 */
  double window[4]; /* of the world, voxels: its centre, x and y, its width and height */
} evo_view;
/* Draws an environment into `pixels`, [height][width][3], red, green, blue, rows from the top; no
 * display is needed. `positions`: its points, [n][2], kept before, or NULL for those it has now. */
EVO_API int evo_envs_render(const evo_envs* envs, int32_t environment, const double* positions,
                            const evo_view* view, size_t size, uint8_t* pixels, size_t bytes);
/* A robot's body with its id, as an SVG document `width` pixels wide; for evo_free. */
EVO_API int evo_robots_svg(const evo_robots* robots, size_t index, int32_t width, char** svg);

/* ---- worlds built in code ------------------------------------------------------------- */

/* Named objects in a grid of cells: robots, terrain, packages. */
typedef struct evo_world evo_world;

EVO_API int evo_world_new(evo_world** world);
/* A world of the benchmark's design tool (JSON): a file, or a text. */
EVO_API int evo_world_read(const char* file, evo_world** world);
EVO_API int evo_world_parse(const char* json, evo_world** world);
EVO_API void evo_world_free(evo_world* world);

/* Puts an object with its lower left corner into cell (x, y), y upwards from the floor.
 * `voxels`: [rows][columns], from the top. `links`: [link_count][2] pairs of adjacent cells, by
 * row * columns + column, that are joined; NULL joins all neighbours. */
EVO_API int evo_world_add(evo_world* world, const char* name, const uint8_t* voxels, int32_t rows,
                          int32_t columns, const int32_t* links, size_t link_count, int32_t x,
                          int32_t y);
/* How stiff each voxel of an object is: [rows][columns] factors of its material, 0.1 to 10. */
EVO_API int evo_world_stiffen(evo_world* world, const char* name, const double* factors,
                              size_t count);
/* Moves an object, or takes it out. */
EVO_API int evo_world_move(evo_world* world, const char* name, int32_t x, int32_t y);
EVO_API int evo_world_remove(evo_world* world, const char* name);
EVO_API int evo_world_json(const evo_world* world, char** json); /* for the design tool; evo_free */

/* Simulations of one world, side by side: without task, observation and reward, and with any
 * number of robots. */
typedef struct evo_sims evo_sims;

/* `physics`: a profile by name or file, NULL for the benchmark's. */
EVO_API int evo_sims_open(const evo_world* world, const char* physics, int32_t sims,
                          int32_t threads, evo_sims** opened);
EVO_API void evo_sims_free(evo_sims* sims);

enum evo_sim_status {
  EVO_SIM_OK = 0,
  EVO_SIM_FOLDED = 1,  /* a robot folded onto itself in the last step, which stopped there */
  EVO_SIM_UNSTABLE = 2 /* values are not finite any more; all that is left is a reset */
};

typedef struct evo_sim_arrays {
  size_t sims;              /* S */
  size_t points;            /* P, of one simulation: all point masses of the world */
  size_t actuators;         /* A, of one simulation: of all robots, in the order of objects */
  const double* positions;  /* [S][P][2] */
  const double* velocities; /* [S][P][2] */
  const uint8_t* status;    /* [S] evo_sim_status */
  double action_low;        /* targets are clipped to this range */
  double action_high;
  size_t voxels; /* V, of one simulation: of all objects, each from its top left */
} evo_sim_arrays;
EVO_API int evo_sims_arrays(const evo_sims* sims, evo_sim_arrays* arrays, size_t size);

/* Back to the initial shapes, at rest: one simulation, or all (-1). */
EVO_API int evo_sims_reset(evo_sims* sims, int32_t sim);
/* One control step. `targets`: [S][A] lengths of actuators as shares of their rest lengths.
 * `active` as for evo_envs_step. */
EVO_API int evo_sims_step(evo_sims* sims, const double* targets, size_t values,
                          const uint8_t* active, size_t active_values);
EVO_API int evo_sims_save(const evo_sims* sims, int32_t sim, void** bytes, size_t* count);
EVO_API int evo_sims_restore(evo_sims* sims, int32_t sim, const void* bytes, size_t count);

/* From now on every step is kept, so that gradients can be pulled back through it; what was kept
 * before is forgotten. `onset`: half the width, voxels, that the onset of contact is spread over,
 * 0 to 0.1: docs/gradients.md. Below 0: nothing is kept any more. */
EVO_API int evo_sims_record(evo_sims* sims, double onset);

/* Derivatives of one number of each simulation's. */
typedef struct evo_sim_gradients {
  size_t sims;        /* S, P and A as in evo_sim_arrays */
  size_t points;      /* P */
  size_t actuators;   /* A */
  size_t voxels;      /* V */
  double* positions;  /* [S][P][2], by where points are */
  double* velocities; /* [S][P][2], by how fast they are */
  double* previous;   /* [S][P][2], by where they were one substep before, which contact uses */
  double* targets;    /* [S][A], by the step's targets */
  double* stiffness;  /* [S][V], by the factors of voxels' stiffness, or NULL */
  double* constants;  /* [S][5], by gravity, drag, contact_stiffness, contact_damping and
                         friction_multiplier, or NULL */
} evo_sim_gradients;
/* Back through the last step that is kept and has not been gone back through: of simulations that
 * it moved, derivatives by the state after it become those by the state before it; those by
 * targets are set, those by stiffness and constants are added to. All but these are 0 where a
 * robot folded or the simulation became unstable. What simulations are now stays. */
EVO_API int evo_sims_pull_back(evo_sims* sims, const evo_sim_gradients* gradients, size_t size);

/* As evo_envs_translate. */
EVO_API int evo_sims_translate(evo_sims* sims, int32_t sim, size_t object, double x, double y);
/* Moves every point by up to `jitter` voxels in each coordinate; velocities stay. */
EVO_API int evo_sims_perturb(evo_sims* sims, int32_t sim, double jitter, uint64_t seed);

/* Objects in the order of points: those with actuators first, then by name. */
typedef struct evo_sim_object {
  const char* name; /* as long as the simulations */
  size_t first_point;
  size_t points;
  size_t first_actuator;
  size_t actuators;
} evo_sim_object;
EVO_API int evo_sims_object_count(const evo_sims* sims, size_t* count);
EVO_API int evo_sims_object(const evo_sims* sims, size_t index, evo_sim_object* object,
                            size_t size);
/* How far an object is turned from its initial shape, counter-clockwise, radians, as the
 * benchmark measures it: [count], of each simulation's present positions (NULL), or of
 * these, [count][P][2]. */
EVO_API int evo_sims_orientation(const evo_sims* sims, size_t object, const double* positions,
                                 double* angles, size_t count);

/* As evo_envs_render. */
EVO_API int evo_sims_render(const evo_sims* sims, int32_t sim, const double* positions,
                            const evo_view* view, size_t size, uint8_t* pixels, size_t bytes);

/* ---- controllers ---------------------------------------------------------------------- */

/* A trained controller with what it belongs to. */
typedef struct evo_policy evo_policy;

EVO_API int evo_policy_read(const char* file, evo_policy** policy);
/* A file for evo-eval, evo-render, evo-convert; appears whole or not at all. */
EVO_API int evo_policy_write(const evo_policy* policy, const char* file);
EVO_API void evo_policy_free(evo_policy* policy);
/* What it earned in episodes from perturbed starts is kept with it. */
EVO_API int evo_policy_set_final(evo_policy* policy, int32_t episodes, double mean,
                                 double standard_error);

/* An evaluation in the course of a training, and the best until then. */
typedef struct evo_curve_point {
  int64_t step; /* environment steps */
  double evaluation;
  double best;
} evo_curve_point;

typedef struct evo_policy_facts {
  size_t observation_length; /* D; 0 for a modular policy, which acts on voxels of any robot */
  size_t action_length;      /* A; 0 likewise */
  double fitness;            /* the best evaluation */
  size_t curve_points;
  const evo_curve_point* curve; /* as long as the policy */
  uint64_t seed;                /* of its training and evaluations */
} evo_policy_facts;
EVO_API int evo_policy_describe(const evo_policy* policy, evo_policy_facts* facts, size_t size);
EVO_API int evo_policy_task(const evo_policy* policy, evo_task** task); /* with its physics */

/* An episode of a task of one's own: T steps, P points, D observations, A actions. */
typedef struct evo_episode {
  const char* task_yaml;      /* what is known of the task: `hold: 5` and the like; may be "" */
  size_t steps;               /* T */
  size_t observation_values;  /* (T + 1) D */
  size_t action_values;       /* T A */
  const double* observations; /* [T + 1][D] */
  const double* actions;      /* [T][A] */
  const double* rewards;      /* [T] */
  const double* positions;    /* [T + 1][P][2] */
  uint8_t terminated;         /* how it ended */
  uint8_t truncated;
} evo_episode;
/* Writes an episode of a policy as a rollout, for evo-render, evo-report and others: the one from
 * the official start of its task, or, of a task of one's own, this one in the world of `sims`. Both
 * are NULL, or neither. */
EVO_API int evo_policy_record(const evo_policy* policy, const evo_sims* sims,
                              const evo_episode* episode, size_t size, const char* file);

/* The deterministic controller: observations [count][D] at steps [count] of their episodes in,
 * actions [count][A] out. */
EVO_API int evo_policy_act(const evo_policy* policy, const double* observations,
                           const int32_t* steps, size_t count, double* actions,
                           size_t action_values);
/* The same for all environments as they are now, as evo_envs_step takes it: `values` as
 * evo_arrays.action_values. A modular policy acts on every robot of its task, others on robots with
 * as many observations and actions as their own; EVO_DATA for any other. What does not change from
 * step to step is kept until another policy acts. */
EVO_API int evo_envs_act(evo_envs* envs, const evo_policy* policy, double* actions, size_t values);

typedef struct evo_training {
  const char* profile;    /* a training profile, by name or file; NULL: "default" */
  const char* const* set; /* settings of it: "gamma=0.995" */
  size_t set_count;
  int64_t steps; /* environment steps; 0: the profile's */
  uint64_t seed;
  /* Called after every update with the environment steps so far; 0 ends the training. */
  int (*go_on)(int64_t step, void* user);
  void* user;
} evo_training;
/* As evo-train, to the same bytes, in the calling thread. `training` may be NULL. EVO_WORK where
 * the training failed or was ended. */
EVO_API int evo_train(const evo_task* task, const evo_robots* robots, size_t index,
                      const evo_training* training, size_t size, evo_policy** policy);

/* ---- a learner for environments of one's own ------------------------------------------ */

/* The suite's PPO, for environments that the suite does not know. Whoever has them tells it what
 * was seen and earned:
 *
 *   evo_learner_observe(l, observations, ..)          the first states
 *   for each update, and in it `rollout` times:
 *     evo_learner_act(l, actions, ..)                 targets for all environments
 *     evo_learner_reward(l, rewards, .., reached, ..) what they earned, before ended ones are reset
 *     evo_learner_observe(l, observations, ..)        and after
 *   evo_learner_learn(l)                              after each rollout
 *
 * With a task of the suite, and its seeds, this gives the policy that evo_train does, to the last
 * bit. A call out of turn is EVO_USAGE; EVO_WORK, numbers that are not finite any more, ends it. */
typedef struct evo_learner evo_learner;

typedef struct evo_learner_facts {
  int32_t environments; /* E, that it learns from side by side */
  int32_t rollout;
  int64_t updates;             /* of the whole training */
  int32_t evaluation_interval; /* updates, after which the suite would evaluate the policy, */
  int32_t evaluation_episodes; /* by the mean of so many episodes, */
  double evaluation_jitter;    /* whose start coordinates are moved by up to this, voxels */
  double start_jitter;         /* the same of episodes that it learns from, */
  double final_jitter;         /* and of those by which it judges the best policy in the end */
  int32_t final_episodes;      /* 0: by none */
  int32_t reserved;
} evo_learner_facts;

/* `training` as for evo_train; D observations and A actions, from `low` to `high`, of an
 * environment. `name` is part of the seed; evo_train's is the robot's id. */
EVO_API int evo_learner_open(const evo_training* training, size_t size, int32_t observation_length,
                             int32_t action_length, double low, double high, const char* name,
                             evo_learner** learner);
EVO_API void evo_learner_free(evo_learner* learner);
EVO_API int evo_learner_describe(const evo_learner* learner, evo_learner_facts* facts, size_t size);
/* observations: [E][D], `values` of them; steps: [E], of the episodes. */
EVO_API int evo_learner_observe(evo_learner* learner, const double* observations, size_t values,
                                const int32_t* steps, size_t environments);
EVO_API int evo_learner_act(evo_learner* learner, double* actions, size_t values); /* [E][A] */
/* rewards, terminated, truncated: [E]; reached: [E][D] after `steps` [E]. */
EVO_API int evo_learner_reward(evo_learner* learner, const double* rewards,
                               const uint8_t* terminated, const uint8_t* truncated,
                               const double* reached, size_t values, const int32_t* steps,
                               size_t environments);
EVO_API int evo_learner_learn(evo_learner* learner);
/* The present policy, with a robot and a curve [points] to be kept with it, and what the task is
 * called. Tools that evaluate policies do not know the task; evo_policy_act acts anywhere. */
EVO_API int evo_learner_policy(const evo_learner* learner, const evo_robots* robots, size_t index,
                               const char* task, const evo_curve_point* curve, size_t points,
                               evo_policy** policy);

#ifdef __cplusplus
}
#endif
#endif
