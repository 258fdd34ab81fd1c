#include "simulate/md/engine/event_engine_body.inl"

namespace grainfield::simulate {

template std::unique_ptr<Engine> make_event_engine<Tangential::coulomb>(const MdSystem&,
                                                                        const EngineOptions&);

}  // namespace grainfield::simulate
