import type { Catalogue, Parameter, SceneInstrument } from '../../src/engine/messages';

/** What the stand-in session offers: a little of everything that the protocol knows. */
export const catalogue: Omit<Catalogue, 'type'> = {
  scenes: [
    { name: 'liver-resection', title: 'Resection of the left lobe of a liver' },
    { name: 'liver-pull', title: 'A liver pulled by its edge' },
  ],
  recordings: [{ name: 'resection', title: 'A resection', scene: 'liver-resection', seconds: 8 }],
  laws: [{ name: 'st-venant-kirchhoff', title: 'St Venant–Kirchhoff', summary: '' }],
  models: [{ name: 'total-lagrangian', title: 'Total Lagrangian', summary: '' }],
  integrators: [{ name: 'explicit', title: 'Explicit', summary: '' }],
  instruments: [
    { kind: 'grasper', title: 'Grasper', summary: 'Takes tissue between its jaws.', trigger: 'closes the jaws' },
    { kind: 'cautery', title: 'Cautery', summary: 'Burns what it touches.', trigger: 'switches the current on' },
    { kind: 'probe', title: 'Probe', summary: 'Pushes and slides.', trigger: '' },
  ],
  colourings: [
    { name: 'none', title: 'Tissue', unit: '', summary: 'The tissue as it looks.' },
    { name: 'displacement', title: 'Displacement', unit: 'm', summary: 'How far each point is from its rest.' },
    { name: 'stress', title: 'Von Mises stress', unit: 'Pa', summary: 'How hard the tissue is sheared.' },
    { name: 'volume', title: 'Volume change', unit: '', summary: 'How much the tissue swells or shrinks.' },
  ],
  meshFormats: ['msh', 'vtk', 'stl'],
};

export function sceneInstruments(): SceneInstrument[] {
  const shaft = { radius: 0.0025, length: 0.3 };
  return [
    { instrument: 0, kind: 'grasper', name: 'grasper', scripted: false, shaft, reach: 0.01, jaw: { length: 0.02, radius: 0.002, widest: 0.7 } },
    { instrument: 1, kind: 'cautery', name: 'cautery', scripted: false, shaft, reach: 0.005, hook: { length: 0.006, radius: 0.0007 }, trocar: [0.06, 0.2, 0.11] },
    { instrument: 2, kind: 'probe', name: 'probe', scripted: false, shaft, reach: 0.0025 },
  ];
}

export function parameters(): Parameter[] {
  const number = { kind: 'number', scale: 'linear', effect: 'continues', group: 'liver' } as const;
  return [
    { ...number, kind: 'choice', key: 'liver.model', title: 'force model', summary: 'How forces are found', unit: '', value: 'total-lagrangian', default: 'total-lagrangian', effect: 'continues', choices: [{ name: 'total-lagrangian', title: 'Total Lagrangian', available: true }, { name: 'corotational', title: 'Corotational', available: false, reason: 'not for this law' }] },
    { ...number, kind: 'choice', key: 'liver.law', title: 'law', summary: '', unit: '', value: 'st-venant-kirchhoff', default: 'st-venant-kirchhoff', effect: 'continues', choices: [{ name: 'st-venant-kirchhoff', title: 'St Venant–Kirchhoff', available: true }] },
    { ...number, key: 'liver.law.young', title: 'stiffness (Young)', summary: 'Stress per strain', unit: 'Pa', value: 3000, default: 3000, low: 300, high: 30000, scale: 'logarithmic' },
    { ...number, key: 'liver.law.poisson', title: 'Poisson ratio', summary: '', unit: '', value: 0.4, default: 0.4, low: 0, high: 0.49, least: 0, most: 0.5, mostExcluded: true },
    { ...number, kind: 'vector', key: 'liver.law.fibre', title: 'fibre direction', summary: '', unit: '', value: [1, 0, 0], default: [1, 0, 0], effect: 'continues' },
    { ...number, key: 'liver.volume', title: 'volume stiffness', summary: '', unit: 'Pa', value: 20000, default: 20000, low: 0, high: 100000 },
    { ...number, key: 'liver.density', title: 'density', summary: '', unit: 'kg/m³', value: 1060, default: 1060, low: 500, high: 2000, effect: 'restarts' },
    { ...number, group: 'world', kind: 'choice', key: 'world.integrator', title: 'integrator', summary: '', unit: '', value: 'explicit', default: 'explicit', effect: 'continues', choices: [{ name: 'explicit', title: 'Explicit', available: true }, { name: 'implicit', title: 'Implicit Euler', available: true }] },
    { ...number, group: 'world', key: 'world.step', title: 'time step', summary: '', unit: 's', value: 0.01, default: 0.01, low: 0.001, high: 0.05, scale: 'logarithmic' },
    { ...number, group: 'world', kind: 'flag', key: 'world.gravity-on', title: 'gravity', summary: '', unit: '', value: true, default: true, effect: 'continues' },
  ];
}
