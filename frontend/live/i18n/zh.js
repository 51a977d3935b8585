// The words of the panels, Chinese.

import {named, said} from './zh-said.js';

const capital = (words) => words;

/** Names stand in sentences with blanks around them; between Chinese signs there is none. */
const tight = (words) => words.replace(/(?<=[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef]) +(?=[\u3000-\u303f\u4e00-\u9fff\uff00-\uffef])/g, '');

export const zh = {
  named, said, tight,
  skip: '跳到曲线', wait: '正在加载……', stop: '。', and: '；', close: '关闭', cancel: '取消', remedyIs: (words) => `解决办法：${words}`, copy: '复制', copied: '已复制',

  pages: '页面', page: {live: '实时', runs: '仿真', plants: '对象', records: '记录'},
  moreActions: '分享、导出、语言和外观',
  share: '分享', shareHint: '本会话的链接', export: '导出', exportHint: '本会话的数据、图片和报告',
  present: '演示模式', look: '浅色或深色', help: '按键',
  presentHint: '演示模式：大号字体，适合投影 (P)', leave: '退出', leaveHint: '退出演示模式 (P, Esc)', themeHint: '浅色或深色 (T)', helpHint: '页面按键 (?)',
  languageHint: '语言：English 或 中文 (L)',
  connections: {starting: '正在启动……', live: '实时', reconnecting: '连接断开，正在重试', ended: '已结束', full: '已满', failed: '没有会话'},
  viewing: '仅观看', viewers: (n) => `${n} 人在看`, slow: (rate) => `${rate}，机器繁忙`,

  chooseExperiment: '选择其他实验', findExperiment: '查找实验',
  sizes: (channels, observers) => `${channels} 个故障通道，${observers} 个观测器`,

  plant: '被控对象', equations: '方程', plantPicture: (title) => `${title}：输入、故障位置、输出和观测器`,
  blocks: {actuator: '执行器', plant: '对象', l1: 'L1', hysteresis: '迟滞', l2: 'L2', sensor: '传感器'},
  observersBlock: '观测器', fromInputs: '来自', fromOutputs: '来自', manyStates: (n) => `${n} 个状态`, every: (s) => `每 ${s} s`,
  activeNow: '存在', namedNow: '已发现', perhapsNow: '可能', siteOf: (title) => `注入：${title}`, siteOfOutput: (name) => `干扰 ${name} 的测量`,

  injectTitle: '注入故障', moreFaults: '+ 卡死、丢失……', fewerFaults: '− 卡死、丢失……', noChannels: '该对象没有故障通道。',
  inject: '注入', clear: '清除', change: '更改', since: (t) => `自 ${t}`, began: (from, to) => `始于 ${from}–${to}`, shapeOf: (title) => `故障形状：${title}`,
  kinds: {actuator: '执行器', process: '过程', sensor: '传感器', measurement: '测量'},
  measurementOf: (name) => capital(name), noise: '噪声', noiseOf: (name) => `${name} 的噪声标准差`, noiseHeld: (s) => `σ，保持 ${s} s`,
  moreOf: (title) => `故障的更多设置：${title}`, endsAfter: (s) => `持续 ${s} s`, endHint: '经过多少秒自行结束；留空则一直持续',
  shapes: {step: '阶跃', ramp: '斜坡', drift: '漂移', exponential: '缓变', sine: '正弦', 'pulse-train': '脉冲串', 'random-walk': '随机游走', table: '表格',
    stuck: '卡死', freeze: '冻结', dropout: '丢失', outliers: '野值', 'noise-burst': '噪声突发', quantisation: '量化', delay: '延迟'},
  fields: {size: '大小', rate: '速率', duration: '时长', time_constant: '时间常数', frequency: '频率', phase: '相位', period: '周期', width: '宽度',
    intensity: '强度', sample_time: '采样时间', times: '时刻', values: '数值', interpolation: '插值', value: '值', probability: '概率', std: 'σ',
    resolution: '分辨率', delay: '延迟', end: '持续时间'},

  tryThis: '试一试', doIt: '执行',

  asOfNow: (t) => `现在，${t}`,
  diagnosis: '诊断', findings: '诊断结果', howSure: '有多可靠？', canSee: '能看到什么？', or: '或', foundIn: '发现用时', notFound: '尚未发现', noFaultActs: '并无故障', faultElsewhere: '不是它',
  isOver: '故障已结束', plannedAt: (t) => `将于 ${t}`, besides: (what) => `同时有 ${what.join('、')}。`, inAll: (size) => `合计 ${size}。`, moreFrom: (what) => `另计划：${what.join('，')}。`,
  part: ({size, shape, t}) => `${size || shape}（自 ${t}）`, partFrom: ({size, shape, t}) => `${size || shape}（自 ${t}）`, coming: ({name, t}) => `等待中：${name} 将于 ${t} 开始。`, cleared: '已解除', ifIt: (name) => `若为 ${name}`, tooSmall: (size) => `小于目前可见的最小值 ${size}`, suspects: '怀疑传感器：卡死、丢失、延迟',
  invite: '点击对象图中的圆圈，或按“注入”。诊断只看到 u 和 y，看不到故障。',
  inviteOutputs: '点击对象图中的圆圈，或按“注入”。诊断只看到 y，看不到故障。',
  unknownSize: '模型之外',
  sentences: {
    noDiagnosis: ({note}) => `没有诊断：${note}。`,
    broken: ({at}) => `对象于 ${at} 失控，此后无法判断。请回到此前的时刻。`,
    lost: ({label, at, count: n, all, only}) => (only ? `未发现故障。但 ${label} 于 ${at} 发散，不再有任何估计。`
      : all ? `未发现故障。但全部 ${n} 个观测器都已发散，不再有任何估计。`
        : n > 1 ? `未发现故障。但有 ${n} 个观测器发散。` : `未发现故障。但 ${label} 于 ${at} 发散。`),
    early: ({from}) => `尚未发现故障；自 ${from} s 起判断。`,
    quiet: () => '没有故障，一切平静。',
    quietAgain: () => '所有故障都已结束。',
    ending: () => '故障已结束，报警即将解除。',
    one: ({name, kind, size, since}) => `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起。`,
    oneFound: ({name, kind, size, since, took}) => `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起，${took} 后发现。`,
    oneAgain: ({name, kind, size, since, again}) => `${name}${kind ? ` ${kind}故障` : ''}：${size}，自 ${since} 起。${again} 的新故障在该报警解除之前到来。`,
    several: ({count: n}) => `${n} 个故障，全部识别。`,
    allNamed: ({count: n, name, took}) => `${n} 个故障，全部识别。${name} 在出现 ${took} 后被发现。`,
    either: ({names}) => `${names.join(' 或 ')}：当前输入无法区分。`,
    unexplained: ({name}) => `模型中没有故障能解释 ${name}。请怀疑其传感器。`,
    looking: ({name, count: n, open}) => (n > 0 ? `已识别 ${n} 个故障。${name} 尚未发现。` : `存在 ${open} 个故障，尚未发现。`),
    hidden: ({name, count: n}) => `${n > 0 ? `已识别 ${n} 个故障。` : ''}${name} 存在但不可见：当前输入下不可辨识。`,
    measurement: ({name}) => `测量 ${name} 受到干扰，尚未发现。`,
    falseAlarm: ({name}) => `${name} 报警，但该处并无故障。`,
    blamed: ({name, otherName, onChannel}) => (onChannel ? `${otherName} 的故障被归咎于 ${name}。` : `测量 ${otherName} 的干扰被归咎于 ${name}。`),
  },
  calibrated: (rate, threshold, runs, hours) => `要求：${rate}。由 ${runs} 次无故障仿真（共 ${hours} h）得到阈值 ${threshold}，并非人为给定。`,
  oneIn: (hours) => `${hours} h 内一次误报`, perHour: (n) => `每小时 ${n} 次误报`,
  plusMinus: (percent) => `± 是大小的 ${percent} % 区间，前提是除已指出的故障外没有其他故障作用。`, judgedFrom: (s) => `${s} s 之前不作判断。`,
  noiseSeen: (output, declared, seen) => `${output} 的噪声：${declared === null ? '未声明' : `声明为 ${declared}`}，实际 ${seen}。`,
  bandsAre: '报警由一个检测器给出，与所用观测器无关。各观测器的置信带是其自身的：两侧各两倍标准差，输入提供的信息越少越宽。',
  alongTrajectory: '沿轨迹的秩与条件数', rank: '秩', condition: '条件数', windowFrom: (s) => `${s} s 窗口起点，s`,
  byEquations: (rank, size) => `按方程，秩 ${rank} / ${size}。`,
  levelOf: (now, needed) => `最不可见者：高出噪声 ${now} 倍；要求 ${needed} 倍。`, overLast: (s) => `最近 ${s} s。`,
  smallest: '可见自', smallestHint: '在最长窗口内可发现的最小阶跃，其他故障未知', typical: '典型',
  canBeSeen: '可区分', underNoise: '淹没于噪声', notSeenNow: '目前不可辨识', hardlySeen: '难以区分',
  unresolved: (names) => `${names.join('、')} 在此噪声下无法分辨。`,
  propose: '建议一个输入', proposeHint: '在对象上试验若干输入，取能区分故障的最小者', proposing: '正在对象上试验输入……',
  apply: '采用', dismiss: '关闭', applied: '已采用。请看激励水平上升。',

  observers: '观测器', add: '+ 添加', addObserver: '添加观测器', addIt: '添加', kind: '观测器类型', label: '标签', estimates: '估计', whichChannels: '全部故障……', notHere: '（不适用于该对象）', automatic: '自动',
  startObserver: '重新启动', startObserverHint: '以现有增益从初始估计重新开始',
  removeObserver: (label) => `移除 ${label}`, noObserver: '没有观测器。', moreGains: '更多增益', fellAt: (t) => `在 ${t} 发散`, lostAt: (label, t) => `${label} 于 ${t} 发散；可在其卡片中重新启动。`,
  assumptions: '假设', verdicts: {holds: '成立', fails: '不成立', 'cannot tell': '无法判断'},
  kindNames: {'high-gain': '高增益', 'zhao-adaptive': '自适应，赵 (34)', 'nonsmooth-adaptive': '非光滑自适应', 'linear-adaptive': '线性自适应',
    'reduced-order': '降阶', 'full-order': '全阶', 'sandwich-nonsmooth': '三明治，非光滑', 'sandwich-conventional': '三明治，常规',
    'adaptive-kalman': '自适应卡尔曼', 'adaptive-kalman-discrete': '自适应卡尔曼，采样', 'joint-ekf': '联合 EKF', 'joint-ukf': '联合 UKF'},

  comparison: '比较', rmseHint: '所示窗口内状态的均方根误差', settle: '收敛', settleHint: '从阶跃故障出现到估计一直保持在阶跃的 10 % 以内的时间，算到现在或下一个故障；若再次离开则撤回',
  noiseShort: '噪声', noiseHint: '窗口最后四分之一内估计相对其趋势的标准差', notYet: '尚未', notSoFar: '该会话尚未到达此时刻',
  alarmWasOn: '其报警早已存在', tooNoisy: '噪声过大', tooNoisyHint: '估计已到达真值，但噪声使其超出阶跃的 10 %，因而不能一直保持在内', whichState: '比较的状态', whichFault: '比较的故障', foundBy: '检测器发现用时', foundHint: '从故障出现到检测器报警指出它的时间；与观测器无关',

  log: '日志', emptyLog: '尚无事件。', showMoment: '显示这一时刻', backHere: '回到这里',
  events: {
    inject: ({name, size, quantity, shape, later}) => `您注入了 ${quantity || size === '' ? `${name}：${shape}${size === '' ? '' : `，${quantity} ${size}`}` : `${name} = ${size}，${shape}`}${later ? `，将于 ${later} s 开始` : ''}`,
    clear: ({name, planned}) => `您清除了${name ? ` ${name}` : '所有故障'}${planned ? '，以及原定的故障' : ''}`,
    'fault-begins': ({name}) => `${name} 开始`, 'fault-ends': ({name}) => `${name} 结束`,
    gain: ({subject, gain, size}) => `您把 ${subject} 的 ${gain || '增益'} 设为 ${size}`,
    signal: ({name}) => `您改变了信号 ${name}`, noise: ({name, size}) => `您把 ${name} 的噪声设为 ${size}`,
    'observer-added': ({subject}) => `${subject} 开始观测`, 'observer-removed': ({subject}) => `${subject} 停止观测`, restarted: ({subject}) => `您重新启动了 ${subject}`,
    alarm: ({names, explained, size}) => (explained ? `报警：${names.join(' 或 ')}${names.length > 1 ? '，无法区分' : `，${size}`}` : `报警：${names[0]}，模型无法解释`),
    'alarm-over': ({names}) => `报警解除：${names.join(' 或 ')}`,
    diverged: ({subject}) => `${subject || '对象'} 发散`, rewound: ({t}) => `回到 ${t} s`, reset: () => '回到起点',
  },

  dialogs: {equations: '方程', help: '按键', share: '分享本会话', export: '带走'},
  with: '其中', measured: '测量', faultsIn: '故障，即琥珀色各项', nextSample: (s) => `x⁺ 是下一采样的值；采样周期 ${s} s。`,
  controlLink: '重新打开同样的会话', controlLinkHint: '在同一时刻打开同样的对象、故障和更改，数值相同。打开者可以更改。',
  viewLink: '观看本会话', viewLinkHint: '实时显示本会话。打开者只能看，不能操作。',
  exportData: '数据', exportPicture: '曲线图片', exportReport: '把会话存为一次仿真', exportNote: '到目前为止的会话存为一次仿真；其数值逐位相同。',
  saving: '正在保存……', report: '报告', reportHint: '一个可离线打开的 HTML 文件', spec: '规格', specHint: '决定数值的全部内容，JSON 格式',
  openRun: '打开仿真', openRunHint: '在单独的页面查看仿真及其图形', csvHint: '所有列，文本格式', matHint: '所有列，供 MATLAB 使用', jsonHint: '所有列，JSON 格式',
  pngHint: '示波器所示，像素图', svgHint: '示波器所示，矢量图',
  keyNames: {Space: '空格', ArrowLeft: '←', ArrowRight: '→', Home: 'Home', End: 'End', Escape: 'Esc'},
  keys: {toggle: '播放或暂停', step: '单步', back: '向前回看', on: '向后查看', now: '回到当前', reset: '回到起点', faster: '加快', slower: '放慢', fork: '从此处分支：第二个会话',
    site: '某个故障通道；按 Enter 注入', clear: '清除所有故障', equations: '方程', present: '演示模式；Esc 退出', desk: '演示模式下：注入、观测器、比较、日志、试一试', theme: '浅色或深色', language: 'English 或 中文', share: '分享', help: '本列表'},
  keysNote: 'Tab 可到达所有控件；方向键移动滑块。',
  tabs: {curves: '曲线', inject: '注入', observers: '观测器', diagnosis: '诊断'}, tabsLabel: '页面的各部分', deskLabel: '面板',
};
