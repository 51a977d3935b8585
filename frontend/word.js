// Names that are words (speed, load_torque) in Chinese: where a symbol would stand there is room for two to five characters.

const WORDS = {
  current: '电流', speed: '转速', voltage: '电压', torque: '转矩', acceleration: '加速度', biomass: '生物量', enzyme: '酶', friction: '摩擦', load: '负载',
  'gain loss': '增益损失', 'load torque': '负载转矩', 'friction increase': '摩擦增大', 'current bias': '电流偏差', 'speed bias': '转速偏差',
};

/** A word of a name, in the page's language. */
export const word = (text) => (document.documentElement.lang.startsWith('zh') ? WORDS[text] ?? text : text);
