// The words of the panels, Chinese.

import {catalogue} from './zh-catalogue.js';
import {names} from './zh-names.js';

const capital = (words) => words;

export const zh = {
  named: (words) => names[words] ?? catalogue[words] ?? words,
  skip: '跳到曲线', wait: '正在加载……', close: '关闭', cancel: '取消', remedy: '解决办法', copy: '复制', copied: '已复制',

  pages: '页面', page: {live: '实时', runs: '仿真', plants: '对象'},
  moreActions: '分享、导出、语言和外观',
  share: '分享', shareHint: '本会话的链接', export: '导出', exportHint: '本会话的数据、图片和报告',
  presentHint: '演示模式：大号字体，适合投影 (P)', themeHint: '浅色或深色 (T)', helpHint: '页面按键 (?)',
  languageHint: '语言：English 或 中文 (L)',
  connections: {starting: '正在启动……', live: '实时', reconnecting: '连接断开，正在重试', ended: '已结束', full: '已满', failed: '没有会话'},
  viewing: '仅观看', viewers: (n) => `${n} 人在看`, slow: (rate) => `${rate}，机器繁忙`,

  chooseExperiment: '选择其他实验', findExperiment: '查找实验',
  sizes: (channels, observers) => `${channels} 个故障通道，${observers} 个观测器`,

  plant: '被控对象', equations: '方程', plantPicture: (title) => `${title}：输入、故障位置、输出和观测器`,
  blocks: {actuator: '执行器', plant: '对象', l1: 'L1', hysteresis: '迟滞', l2: 'L2', sensor: '传感器'},
  observersBlock: '观测器', fromInputs: '来自', fromOutputs: '来自', manyStates: (n) => `${n} 个状态`, every: (s) => `每 ${s} s`,
  activeNow: '存在', siteOf: (title) => `注入：${title}`, siteOfOutput: (name) => `干扰 ${name} 的测量`,

  injectTitle: '注入故障', moreFaults: '+ 卡死、丢失……', fewerFaults: '− 卡死、丢失……', noChannels: '该对象没有故障通道。',
  inject: '注入', clear: '清除', change: '更改', since: (t) => `自 ${t}`, shapeOf: (title) => `故障形状：${title}`,
  kinds: {actuator: '执行器', process: '过程', sensor: '传感器', measurement: '测量'},
  measurementOf: (name) => capital(name), noise: '噪声', noiseOf: (name) => `${name} 的噪声标准差`, noiseHeld: (s) => `σ，保持 ${s} s`,
  moreOf: (title) => `故障的更多设置：${title}`, endsAfter: (s) => `持续 ${s} s`, endHint: '经过多少秒自行结束；留空则一直持续',
  shapes: {step: '阶跃', ramp: '斜坡', drift: '漂移', exponential: '缓变', sine: '正弦', 'pulse-train': '脉冲串', 'random-walk': '随机游走', table: '表格',
    stuck: '卡死', freeze: '冻结', dropout: '丢失', outliers: '野值', 'noise-burst': '噪声突发', quantisation: '量化', delay: '延迟'},
  fields: {size: '大小', rate: '速率', duration: '时长', time_constant: '时间常数', frequency: '频率', phase: '相位', period: '周期', width: '宽度',
    intensity: '强度', sample_time: '采样时间', times: '时刻', values: '数值', interpolation: '插值', value: '值', probability: '概率', std: 'σ',
    resolution: '分辨率', delay: '延迟', end: '持续时间'},

  tryThis: '试一试', doIt: '执行',

  diagnosis: '诊断', howSure: '有多可靠？', foundIn: '发现用时', notFound: '尚未发现', noFaultActs: '该处并无故障', isOver: '故障已结束，估计正在恢复',
  invite: '点击对象图中的圆圈，或按“注入”。观测器只看到 u 和 y，看不到故障。',
  inviteOutputs: '点击对象图中的圆圈，或按“注入”。观测器只看到 y，看不到故障。',
  unknownSize: '大小未知',
  howSureText: '± 是两倍标准差，来自观测器自身的协方差。它只计入测量噪声，不计模型误差。整条置信带离开零并保持在外时才报警。',
  sentences: {
    nobody: () => '没有观测器。请添加一个。',
    allDiverged: () => '所有观测器都已发散。请降低增益，或重新开始。',
    quiet: () => '没有故障，一切平静。',
    quietAgain: () => '所有故障都已结束。',
    cannotName: () => '有故障存在，但这里没有观测器估计故障。请看残差。',
    allNamed: ({count: n, name, took}) => `${n} 个故障，全部识别。${name} 在出现 ${took} 后被发现。`,
    looking: ({name, count: n, open}) => (n > 0 ? `已识别 ${n} 个故障。${name} 尚未发现。` : `存在 ${open} 个故障，尚未发现。`),
    measurement: ({name}) => `测量 ${name} 受到干扰。没有通道对应它：请看残差。`,
    falseAlarm: ({name}) => `${name} 报警，但该处并无故障。`,
    blamed: ({name, otherName, onChannel}) => (onChannel ? `${otherName} 的故障被归咎于 ${name}。` : `测量 ${otherName} 的干扰被归咎于 ${name}。`),
  },

  observers: '观测器', add: '+ 添加', addObserver: '添加观测器', addIt: '添加', kind: '观测器类型', label: '标签', estimates: '估计', whichChannels: '全部故障……', notHere: '（不适用于该对象）', automatic: '自动',
  removeObserver: (label) => `移除 ${label}`, noObserver: '没有观测器。', moreGains: '更多增益', fellAt: (t) => `在 ${t} 发散`,
  assumptions: '假设', verdicts: {holds: '成立', fails: '不成立', 'cannot tell': '无法判断'},
  checkNames: {'canonical form': '规范型', 'uniform observability': '一致可观性', 'A0 − k0 c0 stable': 'A0 − k0 c0 稳定', 'f globally Lipschitz': 'f 全局 Lipschitz',
    'rho at least 1': 'ρ 不小于 1', 'persistent excitation': '持续激励', 'Gamma positive definite': 'Γ 正定', 'P positive definite': 'P 正定', 'S positive definite': 'S 正定',
    observability: '可观性', 'matching condition': '匹配条件', 'Lyapunov inequality': 'Lyapunov 不等式', 'chain of integrators': '积分链', 'A − KC stable': 'A − KC 稳定',
    'γ one-sided Lipschitz': 'γ 单边 Lipschitz', 'vector relative degree': '向量相对阶', 'decoupling matrix nonsingular': '解耦矩阵非奇异', 'α and F Lipschitz': 'α 和 F Lipschitz',
    'no hysteresis': '无迟滞', 'every operator reaches its linear zones': '每个算子都到达线性区', 'innovations consistent with P and R': '新息与 P、R 一致'},
  kindNames: {'high-gain': '高增益', 'zhao-adaptive': '自适应，赵 (34)', 'nonsmooth-adaptive': '非光滑自适应', 'linear-adaptive': '线性自适应',
    'reduced-order': '降阶', 'full-order': '全阶', 'sandwich-nonsmooth': '三明治，非光滑', 'sandwich-conventional': '三明治，常规',
    'adaptive-kalman': '自适应卡尔曼', 'adaptive-kalman-discrete': '自适应卡尔曼，采样', 'joint-ekf': '联合 EKF', 'joint-ukf': '联合 UKF'},

  comparison: '比较', rmseHint: '所示窗口内状态的均方根误差', settle: '收敛', settleHint: '从故障出现到估计在 10 % 以内保持百分之一时长的时间',
  noiseShort: '噪声', noiseHint: '窗口最后四分之一内估计相对其趋势的标准差', notYet: '尚未', whichState: '比较的状态', whichFault: '比较的故障',

  log: '日志', emptyLog: '尚无事件。', showMoment: '显示这一时刻', backHere: '回到这里',
  events: {
    inject: ({name, size, shape}) => `您注入了 ${name}${size === '' ? '' : ` = ${size}`}${shape ? `，${shape}` : ''}`,
    clear: ({name}) => (name ? `您清除了 ${name}` : '您清除了所有故障'),
    'fault-begins': ({name}) => `${name} 开始`, 'fault-ends': ({name}) => `${name} 结束`,
    gain: ({subject, gain, size}) => `您把 ${subject} 的 ${gain || '增益'} 设为 ${size}`,
    signal: ({name}) => `您改变了信号 ${name}`, noise: ({name, size}) => `您把 ${name} 的噪声设为 ${size}`,
    'observer-added': ({subject}) => `${subject} 开始观测`, 'observer-removed': ({subject}) => `${subject} 停止观测`,
    alarm: ({name, size, observer}) => `报警：${name}${size === '' ? '' : `，大小 ${size}`}（${observer}）`, 'alarm-over': ({name, observer}) => `报警解除：${name}（${observer}）`,
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
    site: '某个故障通道：其注入', clear: '清除所有故障', equations: '方程', present: '演示模式', theme: '浅色或深色', language: 'English 或 中文', share: '分享', help: '本列表'},
  keysNote: 'Tab 可到达所有控件；方向键移动滑块。',
  tabs: {curves: '曲线', inject: '注入', observers: '观测器', diagnosis: '诊断'}, tabsLabel: '页面的各部分',
};
