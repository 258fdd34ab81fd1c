#include "simulate/md/event_engine.inl"

namespace grainfield::simulate {

template std::unique_ptr<Engine> make_event_engine<Tangential::coulomb>(const MdSystem&,
                                                                        const EngineOptions&);

}  // namespace grainfield::simulate
