<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="es_ES" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <source>And also:</source>
        <translation>Y también:</translation>
    </message>
    <message>
        <source>Bone:</source>
        <translation>Hueso:</translation>
    </message>
    <message>
        <source>CT:</source>
        <translation>TC:</translation>
    </message>
    <message>
        <source>Connection</source>
        <translation>Conexión</translation>
    </message>
    <message>
        <source>Live</source>
        <translation>En directo</translation>
    </message>
    <message>
        <source>More</source>
        <translation>Más</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Ninguno</translation>
    </message>
    <message>
        <source>None (plain average)</source>
        <translation>Ninguno (media simple)</translation>
    </message>
    <message>
        <source>None yet</source>
        <translation>Todavía ninguno</translation>
    </message>
    <message>
        <source>Open recording, CT, segmentation...</source>
        <translation>Abrir grabación, TC, segmentación...</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Pausa</translation>
    </message>
    <message>
        <source>Place CT on sweep</source>
        <translation>Colocar la TC sobre el barrido</translation>
    </message>
    <message>
        <source>Reconstruct</source>
        <translation>Reconstruir</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Grabar</translation>
    </message>
    <message>
        <source>Recorded</source>
        <translation>Grabado</translation>
    </message>
    <message>
        <source>Say where to move next</source>
        <translation>Decir adónde mover</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Ajustes</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Iniciar</translation>
    </message>
    <message>
        <source>Start over...</source>
        <translation>Empezar de nuevo...</translation>
    </message>
    <message>
        <source>Stop</source>
        <translation>Detener</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Barrido y TC</translation>
    </message>
    <message>
        <source>Sweep:</source>
        <translation>Barrido:</translation>
    </message>
    <message>
        <source>Try it on a sample patient</source>
        <translation>Probar con un paciente de muestra</translation>
    </message>
    <message>
        <source>Use the scanned box</source>
        <translation>Usar la caja explorada</translation>
    </message>
    <message>
        <source>Vertebrae:</source>
        <translation>Vértebras:</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>no iniciado</translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <source>CT agrees: {found}</source>
        <translation>La TC concuerda: {found}</translation>
    </message>
    <message>
        <source>CT does not agree: {found}</source>
        <translation>La TC no concuerda: {found}</translation>
    </message>
    <message>
        <source>Move the probe more slowly: {fast:.0f} mm/s at most.</source>
        <translation>Mueva la sonda más despacio: {fast:.0f} mm/s como mucho.</translation>
    </message>
    <message>
        <source>Place the CT on the sweep before you believe the picture.</source>
        <translation>Coloque la TC sobre el barrido antes de creer la imagen.</translation>
    </message>
    <message>
        <source>Scan {name} again, from other angles.</source>
        <translation>Explore de nuevo {name}, desde otros ángulos.</translation>
    </message>
    <message>
        <source>no sweep yet</source>
        <translation>todavía sin barrido</translation>
    </message>
    <message>
        <source>told after the reconstruction</source>
        <translation>se sabrá tras la reconstrucción</translation>
    </message>
    <message>
        <source>{frames}, {speed:.0f} mm/s</source>
        <translation>{frames}, {speed:.0f} mm/s</translation>
    </message>
    <message>
        <source>{share:.0%} of the echoes, {median:.1f} mm</source>
        <translation>{share:.0%} de los ecos, {median:.1f} mm</translation>
    </message>
    <message>
        <source>{used} of {frames} frames</source>
        <translation>{used} de {frames} imágenes</translation>
    </message>
</context>
<context>
    <name>inputs.readiness</name>
    <message>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation>Elija un barrido o cargue una grabación.</translation>
    </message>
    <message>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation>Sin hueso se promedia el barrido: nada dice en qué ángulo lo encuentra un haz.</translation>
    </message>
</context>
<context>
    <name>panel.lights</name>
    <message>
        <source>Coverage</source>
        <translation>Cobertura</translation>
    </message>
    <message>
        <source>Registration</source>
        <translation>Registro</translation>
    </message>
    <message>
        <source>Tracking</source>
        <translation>Seguimiento</translation>
    </message>
    <message>
        <source>being looked at ...</source>
        <translation>se está mirando...</translation>
    </message>
</context>
<context>
    <name>panel.livePanel</name>
    <message>
        <source>Bring the probe into the tracker's view</source>
        <translation>Ponga la sonda a la vista del rastreador</translation>
    </message>
    <message>
        <source>Press Start</source>
        <translation>Pulse Iniciar</translation>
    </message>
    <message>
        <source>Scan on</source>
        <translation>Siga explorando</translation>
    </message>
    <message>
        <source>not started</source>
        <translation>no iniciado</translation>
    </message>
    <message>
        <source>stopped</source>
        <translation>detenido</translation>
    </message>
</context>
<context>
    <name>panel.recordedPanel</name>
    <message>
        <source>Done.</source>
        <translation>Hecho.</translation>
    </message>
    <message>
        <source>Sweep and CT</source>
        <translation>Barrido y TC</translation>
    </message>
    <message>
        <source>Sweep and CT: {names}</source>
        <translation>Barrido y TC: {names}</translation>
    </message>
</context>
<context>
    <name>panel.signals</name>
    <message>
        <source>good</source>
        <translation>bien</translation>
    </message>
    <message>
        <source>look</source>
        <translation>revisar</translation>
    </message>
    <message>
        <source>not yet</source>
        <translation>aún no</translation>
    </message>
    <message>
        <source>poor</source>
        <translation>mal</translation>
    </message>
</context>
</TS>
