#pragma once
// What Highway's dispatch needs of a pass over lanes, besides its template name_on: plain functions name_mixed and name_full, of
// float and double, and the overloads of name that choose among the vector instructions. A source lists its passes once,
//   #define GRAINLAW_PASSES(PASS) PASS(Result, name, const or nothing, (parameters after the lanes), (their names)) ...
// and expands the list by GRAINLAW_PLAIN_PASS for each kind of instructions, by GRAINLAW_DISPATCHED_PASS under HWY_ONCE. Its
// GRAINLAW_CALL(name_on, lanes, names...) says which instance of the template is called.

#define GRAINLAW_BARE(...) __VA_ARGS__
#define GRAINLAW_PLAIN_PASS(Result, name, Const, parameters, names)          \
  Result name##_mixed(Const Lanes<float>& lanes, GRAINLAW_BARE parameters) { \
    return GRAINLAW_CALL(name##_on, lanes, GRAINLAW_BARE names);             \
  }                                                                          \
  Result name##_full(Const Lanes<double>& lanes, GRAINLAW_BARE parameters) { \
    return GRAINLAW_CALL(name##_on, lanes, GRAINLAW_BARE names);             \
  }
#define GRAINLAW_DISPATCHED_PASS(Result, name, Const, parameters, names)   \
  HWY_EXPORT(name##_mixed);                                                \
  HWY_EXPORT(name##_full);                                                 \
  Result name(Const Lanes<float>& lanes, GRAINLAW_BARE parameters) {       \
    return HWY_DYNAMIC_DISPATCH(name##_mixed)(lanes, GRAINLAW_BARE names); \
  }                                                                        \
  Result name(Const Lanes<double>& lanes, GRAINLAW_BARE parameters) {      \
    return HWY_DYNAMIC_DISPATCH(name##_full)(lanes, GRAINLAW_BARE names);  \
  }
